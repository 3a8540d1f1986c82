"""The sensor tables of the embedded simulator: of a nominal robot, or from measured curves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from realitygap.embedded_sim import Tables
from realitygap.models import load_model, load_tables, save_tables
from realitygap.models.belief.curves import tables_of
from realitygap.reality.capture import capture as captured
from realitygap.studies.plumbing.output import readable, whole_file
from realitygap.studies.plumbing.progress import unseen


def capture(
    out: Path | str,
    *,
    curves: Sequence[Path | str] = (),
    seed: int = 0,  # of the shipped table
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
    tell: Callable[[str], None] = unseen,
) -> Tables:
    """Put a nominal robot before wall and lamp and write the table of what its sensors read.

    Args:
        out: The file (.npz), for `[sensors]` of a model file.
        curves: Measured curves (CSV) of one's own sensors instead: of distance, incidence and
            counts, or of bearing and light.
        seed: Of the nominal sensors' noise.
        force: Replace a table that is there.
        reach: Called with the share that is done, from 0 to 1.
        tell: Called with each sentence about what the curves leave open.

    Raises:
        InputError: `out` cannot be written, or a curve cannot be used.
    """
    with whole_file(Path(out), force=force, ours=readable(load_tables)) as part:
        if curves:
            shipped = load_model().tables
            assert shipped is not None
            tables, notes = tables_of([Path(one) for one in curves], shipped)
            for note in notes:
                tell(note)
        else:
            tables = captured(np.random.SeedSequence(seed), reach)
        save_tables(tables, part)
    return tables

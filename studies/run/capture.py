"""The sensor tables of the embedded simulator, captured from a nominal robot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from realitygap.embedded_sim import Tables
from realitygap.models import load_tables, save_tables
from realitygap.reality import capture as protocol
from realitygap.studies.plumbing.output import readable, whole_file


def capture(
    out: Path | str,
    *,
    seed: int = 0,  # of the shipped table
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> Tables:
    """Put a nominal robot before wall and lamp and write the table of what its sensors read.

    Args:
        out: The file (.npz), for `[sensors]` of a model file.
        seed: Of the sensors' noise.
        force: Replace a table that is there.
        reach: Called with the share that is done, from 0 to 1.

    Raises:
        InputError: `out` cannot be written.
    """
    with whole_file(Path(out), force=force, ours=readable(load_tables)) as part:
        tables = protocol.capture(np.random.SeedSequence(seed), reach)
        save_tables(tables, part)
    return tables

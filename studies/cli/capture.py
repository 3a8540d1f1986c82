"""`realitygap capture`: the sensor tables of the embedded simulator."""

from __future__ import annotations

from typing import Annotated

import typer

from studies.cli import app
from studies.cli.options import Force, Out, Quiet

EXAMPLE = """Example: realitygap capture --out epuck.npz"""

SEED = 0
"""Of the shipped table."""


@app.command(epilog=EXAMPLE)
def capture(
    out: Out,
    seed: Annotated[int, typer.Option(help="Of the sensors' noise.")] = SEED,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Put a nominal robot before wall and lamp and write the table of what its sensors read."""
    import numpy as np

    from embedded_sim.errors import InputError
    from models import save_tables
    from reality.capture import capture as drive_protocol
    from studies.output import whole_file
    from studies.progress import Progress

    if seed < 0:
        raise InputError("--seed", seed, "a number from 0")
    with whole_file(out, force=force) as part, Progress("capture", 1.0, quiet) as shown:
        save_tables(drive_protocol(np.random.SeedSequence(seed), shown.reach), part)
    shown.say(f"sensor tables in {out}")

"""`realitygap capture`: the sensor tables of the embedded simulator."""

from __future__ import annotations

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Out, Quiet, Seed

EXAMPLE = """Example: realitygap capture --out epuck.npz"""


@app.command(epilog=EXAMPLE)
def capture(
    out: Out,
    seed: Seed = 0,  # of the shipped table
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Put a nominal robot before wall and lamp and write the table of what its sensors read."""
    from realitygap.studies.plumbing.progress import Progress

    with Progress("capture", 1.0, quiet) as shown:
        rg.capture(out, seed=seed, force=force, reach=shown.reach)
    shown.say(f"sensor tables in {out}")

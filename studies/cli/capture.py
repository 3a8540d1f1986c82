"""`realitygap capture`: the sensor tables of the embedded simulator."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Out, Quiet, Seed
from realitygap.studies.cli.outcome import Outcome, command


@command(app, epilog="Example: realitygap capture --from infrared.csv --out mine.npz")
def capture(
    out: Out,
    from_: Annotated[
        list[Path] | None,
        typer.Option(
            "--from",
            help="Curve of your own sensors (CSV): distance, incidence, counts; or bearing, light. "
            "One of each kind at most.",
        ),
    ] = None,
    seed: Seed = 0,  # of the shipped table
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Put a nominal robot before wall and lamp and write the table of what its sensors read.

    With --from the table is made from curves that you measured.
    """
    from realitygap.studies.plumbing.progress import Progress

    notes: list[str] = []
    with Progress("capture", 1.0, quiet) as shown:
        rg.capture(
            out, curves=from_ or (), seed=seed, force=force, reach=shown.reach, tell=notes.append
        )
    made = "a nominal robot" if not from_ else ", ".join(map(str, from_))
    result = {"tables": str(out), "notes": notes}
    return Outcome(result, f"sensor tables of {made}", out, notes)

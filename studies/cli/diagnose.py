"""`realitygap diagnose`: what is wrong with the robots."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Model, Out, Quiet, Seed
from realitygap.studies.cli.say import say

EXAMPLE = """Example: realitygap diagnose out/run1 --out out/diagnosis"""


@app.command(epilog=EXAMPLE)
def diagnose(
    log: Annotated[list[Path], typer.Argument(help="Measured logs, or directories of runs.")],
    out: Out,
    model: Model = None,
    reference: Annotated[
        str | None,
        typer.Option(help="Healthy reference, or none; the shipped one of the model if absent."),
    ] = None,
    seed: Seed = 0,
    without: Annotated[
        list[str] | None,
        typer.Option(help="Cause to do without, as if unknown; repeatable."),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Name the cause: which physical fault, of which robots, how large, and how sure.

    Writes diagnosis.json, extended.toml (the model with what was named) and report.html.
    """
    from realitygap.studies.plumbing.progress import Stages

    with Stages("diagnose", quiet) as shown:
        found = rg.diagnose(
            log,
            model=model,
            reference=reference,
            seed=seed,
            without=without or (),
            out=out,
            force=force,
            begin=shown.begin,
        )
    if not quiet:
        for note in found.content["notes"]:
            say(note)
        say(found.sentence)
        say(f"{out / 'report.html'}: written")

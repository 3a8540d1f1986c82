"""`realitygap diagnose`: what is wrong with the robots."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Model, Out, Quiet, Reference, Seed
from realitygap.studies.cli.outcome import Outcome, command

CODES = {"nothing_wrong": 0, "named": 10, "ambiguous": 11, "unexplained": 12, "cannot_tell": 13}
"""Of --exit-code, by verdict; 1 and 2 are failures of any command."""

EXAMPLE = """Example: realitygap diagnose out/run1 --out out/diagnosis"""


@command(app, epilog=EXAMPLE)
def diagnose(
    log: Annotated[list[Path], typer.Argument(help="Measured logs, or directories of runs.")],
    out: Out,
    model: Model = None,
    reference: Reference = None,
    seed: Seed = 0,
    without: Annotated[
        list[str] | None,
        typer.Option(help="Cause to do without, as if unknown; repeatable."),
    ] = None,
    exit_code: Annotated[
        bool,
        typer.Option(
            "--exit-code",
            help="End with 0: nothing wrong, 10: named, 11: ambiguous, 12: unexplained, "
            "13: cannot tell.",
        ),
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
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
    return Outcome(
        found.content,
        found.sentence,
        out / "report.html",
        found.content["notes"],
        code=CODES[found.verdict] if exit_code else 0,
    )

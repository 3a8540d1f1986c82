"""`realitygap gap`: what the simulation gets wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Model, Out, Quiet, Seed
from realitygap.studies.cli.outcome import Outcome, command


@command(app, epilog="Example: realitygap gap out/run1 --out out/gap1")
def gap(
    log: Annotated[Path, typer.Argument(help="Measured log, or the directory of a run or study.")],
    out: Out,
    model: Model = None,
    seed: Seed = 0,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Show what the simulation gets wrong: replay a measured log through the point model.

    Writes gap.json, tidy tables, figures and report.html. A directory with generations.parquet
    (a run's or a study's) adds the gap between simulated and real fitness; without samples, that is
    all.
    """
    from realitygap.studies.plumbing.progress import Stages

    with Stages("gap", quiet) as shown:
        found = rg.measure_gap(log, model=model, seed=seed, out=out, force=force, begin=shown.begin)
    line, *notes = found.summary
    return Outcome(found.content, line, out / "report.html", notes)

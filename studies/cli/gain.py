"""`realitygap gain`: what naming a cause is worth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import (
    MOST_RUNS,
    Engine,
    Force,
    Jobs,
    Minutes,
    Out,
    Quiet,
    Rays,
    Seed,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command, say

EXAMPLE = (
    "Example: realitygap gain --log out/odd --extended out/odd-diagnosis/extended.toml "
    "--effect wheel_radius_mismatch:ratio=1.02,robot=3 --out out/odd-gain"
)


@command(app, epilog=EXAMPLE)
def gain(
    log: Annotated[
        list[Path],
        typer.Option(help="Measured log or run; repeatable. Held out unless it was named from."),
    ],
    extended: Annotated[str, typer.Option(help="The extended.toml of a diagnosis.")],
    out: Out,
    effect: Annotated[
        list[str] | None,
        typer.Option(help="What was hidden: fresh runs are recorded with it; repeatable."),
    ] = None,
    healthy: Annotated[
        list[Path] | None,
        typer.Option(help="Log of sound robots, for the level that can be reached; repeatable."),
    ] = None,
    transfer: Annotated[
        Path | None,
        typer.Option(help="Directory of a finished `study transfer`: the gain in food, beside."),
    ] = None,
    runs: Annotated[
        int, typer.Option(callback=within(1, MOST_RUNS), help="Fresh runs to record.")
    ] = 6,
    minutes: Minutes = 2.0,
    seed: Seed = 0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    jobs: Jobs = None,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Measure the gain: how well an extended model predicts runs that nothing was named from.

    Errors by channel and horizon of the minimal model, of healthy robots, of the extended model
    and, where the truth is known, of the true parameters. Writes gain.json, errors.parquet and
    report.html. The gain in food is measured by `realitygap study transfer`.
    """
    from realitygap.studies.plumbing.progress import Progress

    try:
        with Progress("gain", 1.0, quiet) as shown:
            found = rg.gain(
                log,
                extended,
                effects=effect or (),
                healthy=healthy or (),
                transfer=transfer,
                runs=runs,
                minutes=minutes,
                seed=seed,
                engine=engine,
                rays=rays,
                jobs=jobs,
                out=out,
                force=force,
                reach=shown.reach,
            )
    except rg.GainFailed as error:
        say(f"realitygap: {error}", err=True)
        raise typer.Exit(1) from None
    line, *notes = found.summary
    return Outcome(found.content, line, out / "report.html", notes)

"""`realitygap study transfer`: does the model that was diagnosed bring more food?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli.options import (
    MOST_RUNS,
    Engine,
    Genome,
    Jobs,
    Minutes,
    Quiet,
    Rays,
    Robots,
    Scheduler,
    Seed,
    StudyOut,
    Trials,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command
from realitygap.studies.cli.resume import resumable
from realitygap.studies.cli.study import studied, study

EXAMPLE = "Example: realitygap study transfer --effect window-at-nest --runs 3 --out out/transfer"


@command(study, epilog=EXAMPLE)
def transfer(
    out: StudyOut,
    effect: Annotated[
        list[str] | None,
        typer.Option(
            help="window-at-nest, window-opposite, lamp-moved-45, lamp-moved-90, lamp-moved-135, "
            "half-blind, slow-left-wheel, latency, small-wheels (all if absent), or a SPEC as "
            "`run --effect` takes it; repeatable."
        ),
    ] = None,
    case: Annotated[str, typer.Option(help="Light under which SPECs are tried.")] = "light-at-nest",
    extended: Annotated[
        Path | None,
        typer.Option(help="Extended model on board; diagnosed from a recorded log if absent."),
    ] = None,
    runs: Annotated[
        int, typer.Option(callback=within(1, MOST_RUNS), help="Paired runs of each model.")
    ] = 10,
    bars: Annotated[
        int, typer.Option(callback=within(0, MOST_RUNS), help="Runs of each fixed controller.")
    ] = 3,
    minutes: Minutes = 20.0,
    trials: Trials = 16,
    genome: Genome = "paper",
    robots: Robots = 10,
    seed: Seed = 0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
) -> Outcome:
    """Co-evolve in altered reality with the minimal, the extended and the oracle model on board.

    Writes transfer.json, transfer.csv, runs.csv, figures/ and report.html. Stopped or killed, the
    same command goes on with the runs that are missing.
    """
    with resumable():
        found = rg.study.transfer(
            out,
            effects=effect or (),
            case=case,
            extended=extended,
            runs=runs,
            bars=bars,
            minutes=minutes,
            trials=trials,
            genome=genome,
            robots=robots,
            seed=seed,
            engine=engine,
            rays=rays,
            jobs=jobs,
            scheduler=scheduler,
            quiet=quiet,
        )
    return studied(found)

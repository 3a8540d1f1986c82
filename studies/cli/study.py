"""`realitygap study`: the paper's study, how its text may be read, what food a model brings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import (
    MOST_RUNS,
    Engine,
    Genome,
    Jobs,
    Minutes,
    OnBoard,
    Quiet,
    Rays,
    Robots,
    Scheduler,
    Seed,
    StudyOut,
    Trials,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command, records, resumable

study = typer.Typer(
    name="study",
    help="Whole studies: many runs on every core or on a cluster, resumed where they stopped.",
    no_args_is_help=True,
    rich_markup_mode="rich",
)
app.add_typer(study)


@command(study, epilog="Example: realitygap study paper --runs 2 --minutes 4 --out out/study")
def paper(
    out: StudyOut,
    runs: Annotated[
        int,
        typer.Option(callback=within(1, MOST_RUNS), help="Runs of each of the eleven conditions."),
    ] = 10,
    until_decided: Annotated[
        bool,
        typer.Option(
            "--until-decided",
            help="Add --runs more wherever a claim is open, in other readings and lamps as well.",
        ),
    ] = False,
    minutes: Minutes = 60.0,
    robots: Robots = 10,
    seed: Seed = 0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    model: OnBoard = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
) -> Outcome:
    """Repeat section IV of the paper: its conditions, figures 6 to 8, and every claim decided.

    Three conditions more mix the two controllers that evolve at the nest. A claim holds, does not
    hold, or means no difference that matters; else it is open. Writes study.parquet (a row per
    run), generations.parquet, claims.csv, results.md, figures/ and report.html. Stopped or killed,
    the same command goes on with the runs that are missing.
    """
    with resumable():
        found = rg.study.paper(
            out,
            runs=runs,
            until_decided=until_decided,
            minutes=minutes,
            robots=robots,
            seed=seed,
            engine=engine,
            rays=rays,
            model=model,
            jobs=jobs,
            scheduler=scheduler,
            quiet=quiet,
        )
    return studied(found)


@command(
    study, epilog="Example: realitygap study readings --runs 2 --minutes 10 --out out/readings"
)
def readings(
    out: StudyOut,
    runs: Annotated[
        int, typer.Option(callback=within(1, MOST_RUNS), help="Runs of each condition and variant.")
    ] = 4,
    minutes: Minutes = 30.0,
    robots: Robots = 10,
    seed: Seed = 0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
) -> Outcome:
    """Read the paper otherwise: which claims depend on the reading, on the lamp, on selection.

    Mutation s.d. 2, 0.2, 0.02 with clamped, wrapped or reflected genes; the readings literal and
    neutral; lamps whose contrast fades at 0.6, 1 and 2 m. Writes readings.csv, dependence.csv,
    study.parquet, generations.parquet, figures/ and report.html; resumes like `study paper`.
    """
    with resumable():
        found = rg.study.readings(
            out,
            runs=runs,
            minutes=minutes,
            robots=robots,
            seed=seed,
            engine=engine,
            rays=rays,
            jobs=jobs,
            scheduler=scheduler,
            quiet=quiet,
        )
    return studied(found)


def studied(found: rg.StudyResult) -> Outcome:
    """What came out, with every table but the rows of single generations."""
    tables = {name: records(one) for name, one in found.tables.items() if name != "generations"}
    result = {"outcome": found.outcome, "path": str(found.path), "tables": tables}
    return Outcome(result, found.outcome, found.path / "report.html")


@command(
    study,
    epilog="Example: realitygap study transfer --effect window-at-nest --runs 3 --out out/transfer",
)
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

"""`realitygap study`: the paper's whole study, and the study of how its text may be read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

from studies.cli import app
from studies.cli.options import Jobs, Quiet, Scheduler

study = typer.Typer(
    name="study",
    help="Whole studies: many runs on every core or on a cluster, resumed where they stopped.",
    no_args_is_help=True,
    rich_markup_mode="rich",
)
app.add_typer(study)

Out = Annotated[Path, typer.Option(help="The study's directory; an unfinished one is resumed.")]
Robots = Annotated[int, typer.Option(help="How many e-pucks in each run.")]
Seed = Annotated[int, typer.Option(help="Every run's seed follows from it.")]
Model = Annotated[
    Optional[str],  # noqa: UP045 - typer reads this at run time
    typer.Option(help="Model file on board, or the name of a shipped robot; the e-puck if absent."),
]


@study.command(epilog="Example: realitygap study paper --runs 2 --minutes 4 --out out/study")
def paper(
    out: Out,
    runs: Annotated[int, typer.Option(help="Runs of each of the eight conditions.")] = 10,
    minutes: Annotated[float, typer.Option(help="Simulated minutes of each run.")] = 60.0,
    robots: Robots = 10,
    seed: Seed = 0,
    model: Model = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
) -> None:
    """Repeat section IV of the paper: eight conditions, figures 6 to 8, and every claim tested.

    Writes study.parquet (a row per run), generations.parquet, claims.csv, figures/ and report.html.
    Stopped or killed, the same command goes on with the runs that are missing.
    """
    _study("paper", out, runs, minutes, robots, seed, model, jobs, scheduler, quiet)


@study.command(epilog="Example: realitygap study readings --runs 2 --minutes 10 --out out/readings")
def readings(
    out: Out,
    runs: Annotated[int, typer.Option(help="Runs of each condition and variant.")] = 4,
    minutes: Annotated[float, typer.Option(help="Simulated minutes of each run.")] = 30.0,
    robots: Robots = 10,
    seed: Seed = 0,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
) -> None:
    """Read the paper otherwise: which claims depend on the reading, on the lamp, on selection.

    Mutation s.d. 2, 0.2, 0.02 with clamped, wrapped or reflected genes; the readings literal and
    neutral; lamps whose contrast fades at 0.6, 1 and 2 m. Writes readings.csv, dependence.csv,
    study.parquet, generations.parquet, figures/ and report.html; resumes like `study paper`.
    """
    _study("readings", out, runs, minutes, robots, seed, None, jobs, scheduler, quiet)


def _study(
    name: str,
    out: Path,
    runs: int,
    minutes: float,
    robots: int,
    seed: int,
    model: str | None,
    jobs: int | None,
    scheduler: str | None,
    quiet: bool,
) -> None:
    """Run what is missing, then write the tables and the report."""
    from studies.execution import Workers, WorkersLost
    from studies.paper.conditions import study_config
    from studies.paper.execution import RunsFailed
    from studies.paper.study import run_study

    config = study_config(
        study=name, runs=runs, minutes=minutes, robots=robots, seed=seed, model=model
    )
    workers = Workers.chosen(jobs, scheduler)
    try:
        run_study(config, out, workers, quiet=quiet)
    except (RunsFailed, WorkersLost) as error:
        typer.echo(f"realitygap: {error}; start the command again to go on", err=True)
        raise typer.Exit(1) from None

"""`realitygap study transfer`: does the model that was diagnosed bring more food?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer

from studies.cli.options import Jobs, Quiet, Scheduler
from studies.cli.study import Out, Robots, Seed, study

EXAMPLE = "Example: realitygap study transfer --effect window-at-nest --runs 3 --out out/transfer"


@study.command(epilog=EXAMPLE)
def transfer(
    out: Out,
    effect: Annotated[
        Optional[list[str]],  # noqa: UP045 - typer reads this at run time
        typer.Option(
            help="window-at-nest, window-opposite, lamp-moved-45, lamp-moved-90, lamp-moved-135, "
            "half-blind, slow-left-wheel, latency, small-wheels (all if absent), or a SPEC as "
            "`run --effect` takes it; repeatable."
        ),
    ] = None,
    case: Annotated[str, typer.Option(help="Light under which SPECs are tried.")] = "light-at-nest",
    extended: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Extended model on board; diagnosed from a recorded log if absent."),
    ] = None,
    runs: Annotated[int, typer.Option(help="Paired runs of each model.")] = 10,
    bars: Annotated[int, typer.Option(help="Runs of each fixed controller.")] = 3,
    minutes: Annotated[float, typer.Option(help="Simulated minutes of each run.")] = 20.0,
    trials: Annotated[int, typer.Option(help="Embedded trials per genome.")] = 16,
    genome: Annotated[str, typer.Option(help="paper or continuous.")] = "paper",
    robots: Robots = 10,
    seed: Seed = 0,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
) -> None:
    """Co-evolve in altered reality with the minimal, the extended and the oracle model on board.

    Writes transfer.json, transfer.csv, runs.csv, figures/ and report.html. Stopped or killed, the
    same command goes on with the runs that are missing.
    """
    from studies.execution import Workers, WorkersLost
    from studies.paper.execution import RunsFailed
    from studies.settings import run_config
    from studies.transfer.alterations import chosen
    from studies.transfer.plan import transfer_config
    from studies.transfer.study import run_transfer

    checked = run_config(case=case, robots=robots, genome=genome)
    config = transfer_config(
        alterations=chosen(tuple(effect or ()), checked.case, robots),
        runs=runs,
        bars=bars,
        minutes=minutes,
        robots=robots,
        seed=seed,
        trials=trials,
        genome=genome,
        extended=None if extended is None else str(extended),
    )
    workers = Workers.chosen(jobs, scheduler)
    try:
        run_transfer(config, out, workers, quiet=quiet)
    except (RunsFailed, WorkersLost) as error:
        typer.echo(f"realitygap: {error}; start the command again to go on", err=True)
        raise typer.Exit(1) from None

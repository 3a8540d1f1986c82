"""`realitygap blind`: how well causes are named, tried on effects nobody told the diagnosis of."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import (
    BuildSpread,
    Engine,
    Jobs,
    Quiet,
    Rays,
    Reference,
    Scheduler,
    Seed,
    out_option,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command, resumable


@command(app, epilog="Example: realitygap blind --trials 60 --seed 3 --out out/blind")
def blind(
    out: Annotated[Path, out_option("The battery's directory; an unfinished one resumes.")],
    trials: Annotated[
        int | None,
        typer.Option(
            callback=within(1, 100_000),
            help="Runs (200 if absent), or logs of each cell (10); more extend a battery.",
        ),
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    seed: Seed = 0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    reference: Reference = None,
    only: Annotated[
        list[str] | None,
        typer.Option(help="Effect to draw from, or condition, repeatable; all if absent."),
    ] = None,
    at_bars: Annotated[
        bool, typer.Option("--at-bars", help="Every effect exactly at its bar, in 120 s.")
    ] = False,
    crowd: Annotated[
        int,
        typer.Option(
            callback=within(1, 100), help="Robots of a run that each have an effect of their own."
        ),
    ] = 1,
    kind: Annotated[
        list[str] | None,
        typer.Option(
            help="healthy, single, swarm (all robots have it), pair or unlisted: trials of these "
            "in turn, repeatable; single at the bars, else all."
        ),
    ] = None,
    leave_one_out: Annotated[
        bool,
        typer.Option(
            "--leave-one-out", help="Hide effects whose cause the diagnosis must do without."
        ),
    ] = False,
    seconds: Annotated[
        list[float] | None,
        typer.Option(help="Length of the logs, repeatable; 120 most often, 60 or 240 if absent."),
    ] = None,
    build_spread: BuildSpread = 0.0,
    conditions: Annotated[
        bool,
        typer.Option(
            "--conditions", help="Diagnose one log under many conditions instead, as labs make it."
        ),
    ] = False,
    quiet: Quiet = False,
) -> Outcome:
    """Hide effects at random, diagnose each log in a process that has nothing else, and score.

    Writes blind.json, report.html, figures/ and a file per trial. Stopped or killed, the same
    command goes on with the trials that are missing. With --conditions: conditions.json,
    conditions.md, cells.csv, logs.csv, report.html and a file per log.
    """
    with resumable():
        summary = rg.blind(
            out,
            trials=trials,
            seed=seed,
            engine=engine,
            rays=rays,
            reference=reference,
            only=only or (),
            at_bars=at_bars,
            crowd=crowd,
            kinds=kind or (),
            leave_one_out=leave_one_out,
            seconds=seconds or (),
            build_spread=build_spread,
            conditions=conditions,
            jobs=jobs,
            scheduler=scheduler,
            quiet=quiet,
        )
    if conditions:
        told = summary["summary"]
        line = f"{told['passing']} of {told['cells']} cells pass, {told['silenced']} silenced"
        return Outcome(summary, line, out / "report.html")
    wrong, healthy = summary["wrong_names"], summary["healthy_robots_accused"]
    line = (
        f"{summary['trials']} trials: {wrong['hits']} of {wrong['trials']} names wrong, "
        f"{healthy['hits']} of {healthy['trials']} healthy robots accused"
    )
    return Outcome(summary, line, out / "report.html")

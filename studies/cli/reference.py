"""`realitygap reference`: what healthy robots do."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import (
    MOST_RUNS,
    Force,
    Jobs,
    Model,
    Out,
    Quiet,
    Rays,
    Seed,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command

EXAMPLE = """Example: realitygap reference healthy1.parquet healthy2.parquet --out lab.json"""


@command(app, epilog=EXAMPLE)
def reference(
    out: Out,
    log: Annotated[
        list[Path] | None,
        typer.Argument(help="Measured logs of sound robots, or directories of runs."),
    ] = None,
    model: Model = None,
    runs: Annotated[
        int,
        typer.Option(
            callback=within(0, MOST_RUNS), help="Healthy runs of the nominal world to record."
        ),
    ] = 0,
    manoeuvres: Annotated[
        bool, typer.Option("--manoeuvres", help="Record the manoeuvres of probe:NAME in turn.")
    ] = False,
    seed: Seed = 0,
    engine: Annotated[
        list[str] | None,
        typer.Option(
            help="Physics of their world: pybullet (if absent), pybullet-strict or mujoco (the "
            r"extra \[mujoco]); repeatable: one that knows how these differ."
        ),
    ] = None,
    rays: Rays = "closed",
    jobs: Jobs = None,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Measure health: what sound robots do beyond the model, and how much they differ.

    `diagnose` names only what lies outside it. Use logs of robots you trust, several of them, of
    the kind of motion you will diagnose. With --runs, healthy swarms of the nominal world are
    recorded first: random search without light and co-evolution with it, two minutes each.
    """
    from realitygap.studies.plumbing.progress import Progress

    with Progress("reference", 1.0, quiet) as shown:
        made = rg.measure_health(
            log or (),
            out=out,
            model=model,
            runs=runs,
            manoeuvres=manoeuvres,
            seed=seed,
            engine=engine or ("pybullet",),
            rays=rays,
            jobs=jobs,
            force=force,
            reach=shown.reach,
        )
    return Outcome(out, f"healthy robots: {made.robots}, in runs: {made.swarms}", out)

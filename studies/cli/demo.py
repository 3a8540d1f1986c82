"""`realitygap demo`, `run`: the whole story at once, and one experiment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.embedded_sim.manoeuvres import NAMES
from realitygap.studies.cli import app
from realitygap.studies.cli.options import (
    BuildSpread,
    Engine,
    Force,
    Genome,
    Jobs,
    Minutes,
    OnBoard,
    Out,
    Quiet,
    Rays,
    Seed,
    Trials,
    out_option,
    within,
)
from realitygap.studies.cli.outcome import Outcome, command


@command(app, epilog="Example: realitygap demo --out out/demo --seed 3")
def demo(
    out: Annotated[Path, out_option("Where to write.")] = Path("out/demo"),
    seed: Seed = 0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    jobs: Jobs = None,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Hide an effect, co-evolve, find it in the log alone, correct the simulator, co-evolve again.

    Two to three minutes on two cores. Writes report.html, demo.json, demo.png and what each
    chapter made; sealed.json holds what was hidden and is read only at the end.
    """
    story = rg.demo(out, seed=seed, engine=engine, rays=rays, jobs=jobs, force=force, quiet=quiet)
    return Outcome(out / "demo.json", story.verdict.capitalize(), out / "report.html")


@command(
    app, epilog="Example: realitygap run --case light-at-nest --minutes 10 --seed 1 --out out/run1"
)
def run(
    out: Out,
    case: Annotated[
        str,
        typer.Option(
            help="no-light, light-at-nest, light-opposite-nest, at-nest-to-opposite or "
            "opposite-to-at-nest."
        ),
    ] = "light-at-nest",
    controller: Annotated[
        str,
        typer.Option(
            help="coevolution, search, positive-phototaxis, negative-phototaxis, to-and-fro, "
            "half-to-and-fro, most-to-and-fro, or a manoeuvre, probe:NAME: "
            + ", ".join(NAMES)
            + "."
        ),
    ] = "coevolution",
    minutes: Minutes = 60.0,
    robots: Annotated[int, typer.Option(callback=within(1, 1000), help="How many e-pucks.")] = 10,
    seed: Seed = 0,
    effect: Annotated[
        list[str] | None,
        typer.Option(help="NAME:key=value[,key=value...] to hide in reality; repeatable."),
    ] = None,
    model: OnBoard = None,
    reading: Annotated[
        str, typer.Option(help="Of the paper: default, literal, neutral, reflect or wrap.")
    ] = "default",
    trials: Trials = 1,
    genome: Genome = "paper",
    build_spread: BuildSpread = 0.0,
    engine: Engine = "pybullet",
    rays: Rays = "closed",
    arena_radius: Annotated[
        float,
        typer.Option(
            help="m, from 0.4 to 10; nest and lamps move with the wall, food stays as dense."
        ),
    ] = 0.6,
    no_samples: Annotated[
        bool, typer.Option("--no-samples", help="Positions once a second, no samples.parquet.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Let a swarm forage in a rigid-body world and write what was measured.

    Writes run.json, generations.parquet, deposits.parquet, samples.parquet (the measured log) and,
    apart from them, truth.json: what was hidden with --effect.
    """
    from realitygap.studies.plumbing.progress import Progress

    with Progress("run", 1.0, quiet) as shown:
        found = rg.simulate(
            case=case,
            controller=controller,
            minutes=minutes,
            robots=robots,
            seed=seed,
            engine=engine,
            rays=rays,
            arena_radius=arena_radius,
            effects=effect or (),
            model=model,
            reading=reading,
            trials=trials,
            genome=genome,
            build_spread=build_spread,
            samples=not no_samples,
            out=out,
            force=force,
            reach=shown.reach,
        )
    speed = found.config.minutes * 60.0 / found.totals["wall_seconds"]
    brought = f"items brought to the nest: {found.totals['deposits']:.0f}"
    return Outcome(out / "run.json", f"{brought}, {speed:.0f} times real time", out)

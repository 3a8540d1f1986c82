"""Options that several commands share, so that they mean the same everywhere."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from realitygap.embedded_sim.errors import InputError


def within(low: int, high: int) -> Callable[[typer.CallbackParam, int | None], int | None]:
    """A check that an option is from `low` to `high`, both taken."""

    def check(param: typer.CallbackParam, value: int | None) -> int | None:
        if value is not None and not low <= value <= high:
            expected = f"a whole number from {low} to {high}"
            raise InputError(param.opts[0], value, expected)
        return value

    return check


Engine = Annotated[
    str,
    typer.Option(
        "--engine",
        help=r"Physics of the world: pybullet, pybullet-strict or mujoco (the extra \[mujoco]).",
    ),
]

Rays = Annotated[
    str,
    typer.Option(
        "--rays", help="Who answers what infrared meets: the engine, or a closed form (exact)."
    ),
]


Reference = Annotated[
    str | None,
    typer.Option(
        help="Healthy reference: a file, pybullet or mujoco for a shipped one, or none; "
        "that of the world that recorded the log if absent, else pybullet's."
    ),
]


def target(given: str | Path) -> Path:
    """A path to write to. Python would take no text for the directory one is in."""
    if not str(given):
        raise typer.BadParameter("got '', expected a path")
    return Path(given)


def out_option(text: str) -> Any:
    """`--out` of a command that describes it by `text`."""
    return typer.Option("--out", parser=target, metavar="<path>", help=text)


Out = Annotated[Path, out_option("Where to write; must not exist yet.")]
Force = Annotated[bool, typer.Option("--force", help="Replace what is there.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")]
Model = Annotated[
    str | None,
    typer.Option(help="Model file, or the name of a shipped robot; the e-puck if absent."),
]
OnBoard = Annotated[
    str | None,
    typer.Option(help="Model file on board, or the name of a shipped robot; the e-puck if absent."),
]
MOST_SEED = 2**63 - 1
"""Largest seed: what a column of whole numbers holds."""
MOST_JOBS = 1024
"""Processes; our choice: more than any machine that this was tried on has cores."""
MOST_RUNS = 10_000
"""Runs that a command records; our choice: a study of them takes days."""

Robots = Annotated[int, typer.Option(callback=within(1, 100), help="How many e-pucks in a run.")]
Trials = Annotated[int, typer.Option(callback=within(1, 1000), help="Embedded trials per genome.")]
Seed = Annotated[
    int,
    typer.Option(
        "--seed", callback=within(0, MOST_SEED), help="Everything random follows from it."
    ),
]
Minutes = Annotated[float, typer.Option("--minutes", help="Simulated minutes of each run.")]
"""Its bounds are those of `RunConfig`, which NaN does not pass."""
Genome = Annotated[
    str,
    typer.Option(
        help="paper: the genes G0 and G1; continuous: also avoidance, phototaxis, search."
    ),
]
BuildSpread = Annotated[
    float,
    typer.Option(
        "--build-spread",
        help="Relative standard deviation by which robots' parts differ from nominal, as 0.005.",
    ),
]
"""Its bounds are those of `RunConfig`."""
Jobs = Annotated[
    int | None, typer.Option(callback=within(1, MOST_JOBS), help="Processes; all cores if absent.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        help="tls://host:port of a Dask scheduler whose workers have this program; tcp:// only "
        "where nobody else can reach it: it runs code for whoever does."
    ),
]

StudyOut = Annotated[Path, out_option("The study's directory; an unfinished one is resumed.")]

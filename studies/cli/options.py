"""Options that several commands share, so that they mean the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Out = Annotated[Path, typer.Option(help="Where to write; must not exist yet.")]
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

Robots = Annotated[int, typer.Option(min=1, max=100, help="How many e-pucks in a run.")]
Trials = Annotated[int, typer.Option(min=1, max=1000, help="Embedded trials per genome.")]
Seed = Annotated[
    int,
    typer.Option("--seed", min=0, max=MOST_SEED, help="Everything random follows from it."),
]
Minutes = Annotated[float, typer.Option("--minutes", help="Simulated minutes of each run.")]
"""Its bounds are those of `RunConfig`, which NaN does not pass."""
Genome = Annotated[
    str,
    typer.Option(
        help="paper: the genes G0 and G1; continuous: also avoidance, phototaxis, search."
    ),
]
Jobs = Annotated[
    int | None, typer.Option(min=1, max=MOST_JOBS, help="Processes; all cores if absent.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        help="tls://host:port of a Dask scheduler whose workers have this program; tcp:// only "
        "where nobody else can reach it: it runs code for whoever does."
    ),
]

StudyOut = Annotated[
    Path, typer.Option("--out", help="The study's directory; an unfinished one is resumed.")
]

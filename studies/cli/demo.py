"""`realitygap demo`: see it work."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from studies.cli import app
from studies.cli.options import Force, Quiet

EXAMPLE = """Example: realitygap demo --out out/demo --seed 3"""

MINUTES = 10.0
"""Simulated: time for the swarm to settle on what it believes."""


@app.command(epilog=EXAMPLE)
def demo(
    out: Annotated[Path, typer.Option(help="Where to write.")] = Path("out/demo"),
    seed: Annotated[int, typer.Option(help="Everything random follows from it.")] = 0,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Ten robots co-evolve for ten simulated minutes with the light at the nest; one picture."""
    from studies.experiment import simulate
    from studies.output import whole_directory
    from studies.picture import draw_run
    from studies.progress import Progress
    from studies.settings import run_config

    config = run_config(case="light-at-nest", minutes=MINUTES, seed=seed)
    with whole_directory(out, force=force, holds=("run.json",)) as part:
        with Progress("ten robots co-evolve", config.steps, quiet) as shown:
            totals = simulate(config, (), part, shown.reach)
        draw_run(part, config.case, part / "demo.png")
    if not quiet:
        shown.say(f"{totals['deposits']:.0f} items brought to the nest; see {out / 'demo.png'}")

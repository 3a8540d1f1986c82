"""`realitygap demo`: the whole story at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Engine, Force, Jobs, Quiet, Rays, Seed, out_option
from realitygap.studies.cli.outcome import Outcome, command

EXAMPLE = """Example: realitygap demo --out out/demo --seed 3"""


@command(app, epilog=EXAMPLE)
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

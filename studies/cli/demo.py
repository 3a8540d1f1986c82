"""`realitygap demo`: the whole story at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Jobs, Quiet, Seed
from realitygap.studies.cli.say import say

EXAMPLE = """Example: realitygap demo --out out/demo --seed 3"""


@app.command(epilog=EXAMPLE)
def demo(
    out: Annotated[Path, typer.Option(help="Where to write.")] = Path("out/demo"),
    seed: Seed = 0,
    jobs: Jobs = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Hide an effect, co-evolve, find it in the log alone, correct the simulator, co-evolve again.

    Two to three minutes on two cores. Writes report.html, demo.json, demo.png and what each
    chapter made; sealed.json holds what was hidden and is read only at the end.
    """
    from realitygap.studies.demo.chapters import tell
    from realitygap.studies.demo.report import write_report
    from realitygap.studies.demo.story import Size, as_json, verdict_line
    from realitygap.studies.execution import Workers
    from realitygap.studies.output import whole_directory
    from realitygap.studies.provenance import write_json

    workers = Workers.chosen(jobs, None)
    with whole_directory(out, force=force, holds=("demo.json", "run.json")) as part:
        story = tell(seed, Size(), part, workers, quiet=quiet)
        write_json(part / "demo.json", as_json(story))
        write_report(story, part)
    if not quiet:
        say(f"{verdict_line(story).capitalize()}. See {out / 'report.html'}")

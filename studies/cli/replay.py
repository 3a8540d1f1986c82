"""`realitygap replay`: watch a log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Model, Quiet, out_option
from realitygap.studies.cli.outcome import Outcome, command

EXAMPLE = """Example: realitygap replay out/run1 --out replay.html"""


@command(app, epilog=EXAMPLE)
def replay(
    log: Annotated[Path, typer.Argument(help="Measured log, or the directory of a run.")],
    out: Annotated[Path, out_option("The file (.html, .rrd, .mp4 or .gif).")],
    format: Annotated[
        str | None,
        typer.Option(
            "--format",
            help=r"html, rerun (the extra \[rerun]), mp4 (ffmpeg) or gif; by the ending of --out "
            "if absent.",
        ),
    ] = None,
    model: Model = None,
    restart: Annotated[
        float,
        typer.Option(help="Seconds after which a ghost begins anew at the measured pose."),
    ] = 5.0,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Watch a log: robots, what they sense and believe, and where the model says they are.

    Writes one page that plays in any browser and needs nothing from the network, a recording for
    Rerun, or a film. The model's prediction is drawn as a ghost beside each robot.
    """
    from realitygap.studies.plumbing.progress import Stages

    with Stages("replay", quiet) as shown:
        done = rg.watch(
            log,
            out,
            format=format,
            model=model,
            restart=restart,
            force=force,
            begin=shown.begin,
        )
    seconds = sum(run["seconds"] for run in done["runs"])
    robots = f"{len(done['robots'])} robot{'s' * (len(done['robots']) > 1)}"
    line = f"{robots}, {seconds:.0f} s, {done['bytes'] / 1e6:.1f} MB"
    return Outcome(done, line, out, done["notes"])

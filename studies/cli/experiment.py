"""`realitygap experiment`: what to let the robots do next, as commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Quiet, out_option
from realitygap.studies.cli.outcome import Outcome, command

EXAMPLE = """Example: realitygap experiment out/diagnosis --out commands.csv"""


@command(app, epilog=EXAMPLE)
def experiment(
    diagnosis: Annotated[
        Path, typer.Argument(help="Directory of a diagnosis, or its diagnosis.json.")
    ],
    out: Annotated[
        Path, out_option("A table (.csv, .parquet), or a bag of ROS 2 (.mcap, or a directory).")
    ],
    format: Annotated[
        str | None,
        typer.Option(
            "--format", help=r"table, or ros2 (the extra \[ros]); by the ending of --out if absent."
        ),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Write the manoeuvre that would tell rival causes apart, as commands for these robots.

    Beside the commands stands, as JSON, what each rival lets one expect. Log the manoeuvre, and
    diagnose it together with the first log.
    """
    found = rg.experiment(diagnosis, out=out, format=format, force=force)
    content = found.content
    starts = [
        f"robot {one['robot']} starts at x {one['x']:.3f} m, y {one['y']:.3f} m, yaw "
        f"{one['yaw']:.3f} rad"
        for one in content["starts"]
    ]
    needs = [f"log {', '.join(content['needs'])}"] if content["needs"] else []
    lamp = ["switch the lamp off"] if content["lamp"] == "off" else []
    line = f"{content['manoeuvre']} for {len(starts)} robot{'s' * (len(starts) > 1)}, "
    line += f"{content['seconds']:.0f} s, tells {' from '.join(content['separates'])}"
    return Outcome(content, line, out, [*starts, *needs, *lamp, *found.lines])

"""`realitygap diagnose`, `experiment`: what is wrong, and what to let the robots do next."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Model, Out, Quiet, Reference, Seed, out_option
from realitygap.studies.cli.outcome import Outcome, command

CODES = {"nothing_wrong": 0, "named": 10, "ambiguous": 11, "unexplained": 12, "cannot_tell": 13}
"""Of --exit-code, by verdict; 1 and 2 are failures of any command."""


@command(app, epilog="Example: realitygap diagnose out/run1 --out out/diagnosis")
def diagnose(
    log: Annotated[list[Path], typer.Argument(help="Measured logs, or directories of runs.")],
    out: Out,
    model: Model = None,
    reference: Reference = None,
    seed: Seed = 0,
    without: Annotated[
        list[str] | None,
        typer.Option(help="Cause to do without, as if unknown; repeatable."),
    ] = None,
    exit_code: Annotated[
        bool,
        typer.Option(
            "--exit-code",
            help="End with 0: nothing wrong, 10: named, 11: ambiguous, 12: unexplained, "
            "13: cannot tell.",
        ),
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> Outcome:
    """Name the cause: which physical fault, of which robots, how large, and how sure.

    Writes diagnosis.json, extended.toml (the model with what was named) and report.html.
    """
    from realitygap.studies.plumbing.progress import Stages

    with Stages("diagnose", quiet) as shown:
        found = rg.diagnose(
            log,
            model=model,
            reference=reference,
            seed=seed,
            without=without or (),
            out=out,
            force=force,
            begin=shown.begin,
        )
    return Outcome(
        found.content,
        found.sentence,
        out / "report.html",
        found.content["notes"],
        code=CODES[found.verdict] if exit_code else 0,
    )


@command(app, epilog="Example: realitygap experiment out/diagnosis --out commands.csv")
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

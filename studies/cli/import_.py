"""`realitygap import`: a lab's own format to the measured-log table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Quiet, out_option
from realitygap.studies.cli.say import say

FORMATS = ("csv", "rosbag", "mcap", "tum", "euroc", "lerobot", "optiodom", "mrclam")

EXAMPLE = """Example: realitygap import csv mine.csv --out log.parquet"""


@app.command(name="import", epilog=EXAMPLE)
def import_(
    format_: Annotated[str, typer.Argument(metavar="FORMAT", help=", ".join(FORMATS) + ".")],
    source: Annotated[list[Path], typer.Argument(help="Directory or files of that format.")],
    out: Annotated[
        Path | None, out_option("The log, .parquet or .csv; must not exist yet.")
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(help="Model file, or the name of a shipped robot; the format's if absent."),
    ] = None,
    map_: Annotated[
        Path | None,
        typer.Option(
            "--map", help="Columns of a table, or topics of a bag (TOML); guessed if absent."
        ),
    ] = None,
    commands: Annotated[
        Path | None, typer.Option(help="Table of commands beside a tum or euroc trajectory.")
    ] = None,
    list_: Annotated[
        bool, typer.Option("--list", help="List the topics of a bag, and write nothing.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Turn a lab's own format into the measured-log table.

    csv: any table. rosbag, mcap: ROS 1 and ROS 2. tum, euroc: trajectories, with --commands.
    lerobot: data sets. optiodom: session directories. mrclam: UTIAS multi-robot directories.
    Without --map one is guessed and written beside the log, to be corrected.
    """
    from realitygap.studies.plumbing.progress import Stages

    if list_:
        for one in source:
            for line in rg.topics(one).to_string(index=False).splitlines():
                say(line)
        return
    if out is None:
        raise typer.BadParameter("got nothing, expected a path", param_hint="'--out'")
    with Stages("import", quiet) as shown:
        log = rg.import_log(
            source,
            format=format_,
            out=out,
            model=model,
            map=map_,
            commands=commands,
            force=force,
            begin=shown.begin,
        )
    if quiet:
        return
    if log.guessed:
        for line in (*log.guessed.splitlines(), f"{rg.guessed_map(out)}: written"):
            say(line)
    for note in log.notes:
        say(note)
    say(f"{out}: {log.size}")

"""`realitygap import`: a lab's own format to the measured-log table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Quiet, out_option
from realitygap.studies.cli.outcome import Outcome, command, say_all

FORMATS = ("csv", "rosbag", "mcap", "tum", "euroc", "lerobot", "optiodom", "mrclam")


@command(app, name="import", epilog="Example: realitygap import csv mine.csv --out log.parquet")
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
) -> Outcome:
    """Turn a lab's own format into the measured-log table.

    csv: any table. rosbag, mcap: ROS 1 and ROS 2. tum, euroc: trajectories, with --commands.
    lerobot: data sets. optiodom: session directories. mrclam: UTIAS multi-robot directories.
    Without --map one is guessed and written beside the log, to be corrected.
    """
    from realitygap.studies.plumbing.progress import Stages

    if list_:
        return _topics(source)
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
    map_beside = rg.guessed_map(out) if log.guessed else None
    told = [] if map_beside is None else [*log.guessed.splitlines(), f"{map_beside}: written"]
    result = {
        "log": str(out),
        "map": None if map_beside is None else str(map_beside),
        "rows": len(log.table),
        "runs": log.runs,
        "robots": log.robots,
        "step": log.step,
        "notes": log.notes,
    }
    return Outcome(result, log.size, out, [*told, *log.notes])


def _topics(bags: list[Path]) -> Outcome:
    """What bags hold."""
    import pandas as pd

    table = pd.concat([rg.topics(one).assign(bag=str(one)) for one in bags])

    def show() -> None:
        for _, part in table.groupby("bag", sort=False):
            say_all(part.drop(columns="bag").to_string(index=False).splitlines())

    return Outcome(table, show=show)

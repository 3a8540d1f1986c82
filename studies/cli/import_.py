"""`realitygap import`: a lab's own format to the measured-log table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Out, Quiet
from realitygap.studies.cli.say import say

FORMATS = ("optiodom", "mrclam", "csv")

EXAMPLE = """Example: realitygap import csv mine.csv --out log.parquet"""


@app.command(name="import", epilog=EXAMPLE)
def import_(
    format_: Annotated[str, typer.Argument(metavar="FORMAT", help=", ".join(FORMATS) + ".")],
    source: Annotated[list[Path], typer.Argument(help="Directory or files of that format.")],
    out: Out,
    model: Annotated[
        str | None,
        typer.Option(help="Model file, or the name of a shipped robot; the format's if absent."),
    ] = None,
    map_: Annotated[
        Path | None,
        typer.Option("--map", help="Column names and units of a csv (TOML); guessed if absent."),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Turn a lab's own format into the measured-log table.

    optiodom: session directories. mrclam: UTIAS multi-robot directories. csv: any tables. Without
    --map one is guessed and written beside the log, to be corrected. The log is written as .parquet
    or .csv.
    """
    from realitygap.studies.plumbing.progress import Stages

    with Stages("import", quiet) as shown:
        log = rg.import_log(
            source,
            format=format_,
            out=out,
            model=model,
            map=map_,
            force=force,
            begin=shown.begin,
        )
    if not quiet:
        for line in log.guessed.splitlines():
            say(line)
        for note in log.notes:
            say(note)
        say(f"{out}: {log.size}")

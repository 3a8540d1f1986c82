"""`realitygap import`: a lab's own format to the measured-log table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from embedded_sim.errors import InputError, nearest
from studies.cli import app

FORMATS = {"optiodom": "optiodom"}
"""Formats, and the robot whose geometry they are read with unless --model says otherwise."""


@app.command(name="import")
def import_(
    format_: Annotated[str, typer.Argument(metavar="FORMAT", help=", ".join(FORMATS) + ".")],
    source: Annotated[list[Path], typer.Argument(help="Directory or files of that format.")],
    out: Annotated[Path, typer.Option(help="Log to write: .parquet or .csv.")],
    model: Annotated[
        str | None, typer.Option(help="Model file, or the name of a shipped robot.")
    ] = None,
    map_: Annotated[
        Path | None, typer.Option("--map", help="Column names and units of a csv (TOML).")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing log.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing.")] = False,
) -> None:
    """Turn a lab's own format into the measured-log table.

    Example: realitygap import optiodom 250620202104/ --out log.parquet
    """
    if format_ not in FORMATS:
        raise InputError("FORMAT", format_, nearest(format_, FORMATS))
    from models.formats.optiodom import read_optiodom
    from models.log import make_log, write_table
    from models.modelfile import load_model
    from studies.output import check_free, whole_file

    check_free(out, force=force)
    if out.suffix not in (".parquet", ".csv"):
        raise InputError("--out", out.name, "a file ending in .parquet or .csv")
    drive = load_model(model or FORMATS[format_], sensors="ignored").drive
    if len(source) != 1:
        raise InputError("SOURCE", f"{len(source)} paths", f"one directory of {format_} data")
    table = read_optiodom(source[0], drive=drive)
    log = make_log(table, drive=drive)
    with whole_file(out, force=force) as part:
        write_table(table, part)
    if not quiet:
        for note in log.notes:
            typer.echo(note)
        runs, robots = log.segments["run"].nunique(), log.segments["robot"].nunique()
        typer.echo(
            f"{out}: {len(table)} rows, {runs} runs, {robots} robots, a row each {log.step:g} s"
        )

"""`realitygap import`: a lab's own format to the measured-log table."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.studies.cli import app
from realitygap.studies.cli.options import Force, Out, Quiet
from realitygap.studies.cli.say import say

if TYPE_CHECKING:
    import pandas as pd

    from realitygap.embedded_sim import Drive

FORMATS = {"optiodom": "optiodom", "mrclam": "create", "csv": "epuck"}
"""Formats, and the robot whose geometry they are read with unless --model says otherwise."""


EXAMPLE = """Example: realitygap import optiodom 250620202104/ --out log.parquet"""


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
        Path | None, typer.Option("--map", help="Column names and units of a csv (TOML).")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Turn a lab's own format into the measured-log table.

    optiodom: session directories. mrclam: UTIAS multi-robot directories. csv: files read by --map.
    The log is written as .parquet or .csv.
    """
    from realitygap.models.log import make_log, write_table
    from realitygap.models.modelfile import read_model_file
    from realitygap.studies.output import whole_file
    from realitygap.studies.progress import Stages

    if format_ not in FORMATS:
        raise InputError("FORMAT", format_, nearest(format_, FORMATS))
    if out.suffix not in (".parquet", ".csv"):
        raise InputError("--out", out.name, "a file ending in .parquet or .csv")
    file = read_model_file(model or FORMATS[format_])
    drive = file.nominal_drive
    if out.exists() and any(path.exists() and out.samefile(path) for path in source):
        raise InputError("--out", out, "another file than what is read")
    with whole_file(out, force=force, ours=_is_log) as part, Stages("import", quiet) as shown:
        table = _read(format_, source, map_, drive, shown.begin)
        shown.begin("checking the log")
        log = make_log(table, drive=drive, fastest=file.robot.wheel_speed_max)
        shown.begin(f"writing {out.name}")
        write_table(log.frame, part)
    if not quiet:
        for note in log.notes:
            say(note)
        runs, robots = log.segments["run"].nunique(), log.segments["robot"].nunique()
        rows = f"{len(log.t)} rows, {runs} runs, {robots} robots, a row each {log.step:g} s"
        say(f"{out}: {rows}")


def _is_log(path: Path) -> bool:
    """Whether a file is a table as this command writes it."""
    from realitygap.models.log import read_table

    try:
        return {"run", "robot", "t", "x", "y", "yaw"} <= set(read_table(path).columns)
    except InputError:
        return False


def _read(
    format_: str,
    source: list[Path],
    map_: Path | None,
    drive: Drive,
    begin: Callable[[str], None],
) -> pd.DataFrame:
    """The sources, one after the other, as one table; several csv files become several runs."""
    import pandas as pd

    from realitygap.models.formats.mapped import read_mapped
    from realitygap.models.formats.mrclam import read_mrclam
    from realitygap.models.formats.optiodom import read_optiodom

    if (map_ is None) == (format_ == "csv"):
        said = "a map for this csv" if map_ is None else f"none with {format_}"
        raise InputError("--map", map_, said)
    parts = []
    for number, path in enumerate(source, start=1):
        begin(f"reading {path} ({number} of {len(source)})")
        if format_ == "optiodom":
            part = read_optiodom(path, drive=drive)
        elif format_ == "mrclam":
            part = read_mrclam(path)
        else:
            assert map_ is not None
            part = read_mapped(path, map_)
            if len(source) > 1 and "run" not in part:
                part = part.assign(run=path.stem)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)

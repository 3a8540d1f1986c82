"""Logs of labs, in the formats that labs keep them in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.models.formats.mapped import read_mapped
from realitygap.models.formats.mrclam import read_mrclam
from realitygap.models.formats.optiodom import read_optiodom
from realitygap.models.log import write_table
from realitygap.studies.inputs.logs import (
    AnyLog,
    Log,
    Source,
    as_log,
    checked_out,
    is_log,
    read_logs,
    sources,
)
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.progress import unseen

ROBOTS: dict[str, str] = {"optiodom": "optiodom", "mrclam": "create", "csv": "epuck"}
"""By format: the robot whose geometry it is read with, if no model is given."""


def read_log(
    log: AnyLog,
    *,
    model: AnyModel = None,
    format: str | None = None,
    map: Path | str | None = None,
    begin: Callable[[str], None] = unseen,
) -> Log:
    """Read a measured log: check it, repair it, and count what was repaired.

    Args:
        log: A file (`.parquet`, `.csv`, `.csv.gz`), the directory of a run, or a DataFrame, with
            the columns of the measured log: t (s), x, y (m), yaw (rad), and cmd_left, cmd_right
            (rad/s) or cmd_v, cmd_omega (m/s, rad/s), a row per moment of a robot. A list of them
            becomes one log of several runs.
        model: Of the robot; the e-puck, or the robot of the format, if absent.
        format: What the files are instead: `optiodom` (directories of sessions), `mrclam` (UTIAS
            multi-robot directories) or `csv` (files read by `map`).
        map: Column names and units of a csv (TOML).
        begin: Called with the name of each stage.

    Raises:
        InputError: it cannot be read, or is no usable log: names field, value and what is valid.
    """
    if format is None:
        if map is not None:
            raise InputError("map", map, "a format, csv, that is read by it")
        begin("reading the log")
        return as_log(log, model)
    if format not in ROBOTS:
        raise InputError("FORMAT", format, nearest(format, ROBOTS))
    believed = Model.load(ROBOTS[format] if model is None else model)
    given = [one.path for one in sources(log)]
    paths = [path for path in given if path is not None]
    if not paths or len(paths) != len(given):
        raise InputError("SOURCE", "no path", "files or directories of that format")
    drive = believed.file.nominal_drive
    table = _table(format, paths, None if map is None else Path(map), drive, begin)
    begin("checking the log")
    source = Source(None, table, f"<{format} {', '.join(str(path) for path in paths)}>")
    return Log(read_logs(source, believed.file), (source,), believed)


def import_log(
    log: Path | str | Sequence[Path | str],
    *,
    format: str,
    out: Path | str,
    model: AnyModel = None,
    map: Path | str | None = None,
    force: bool = False,
    begin: Callable[[str], None] = unseen,
) -> Log:
    """Read logs of a lab's own format and write them as one in ours.

    Args:
        log: Files or directories of the format.
        format: As of `read_log`.
        out: `.parquet`, with units in the fields' metadata, or `.csv`; claimed before any work.
        model: As of `read_log`.
        map: As of `read_log`.
        force: Replace a log that is there.
        begin: Called with the name of each stage.

    Raises:
        InputError: as `read_log`, or `out` cannot be written or is what is read.
    """
    if format not in ROBOTS:
        raise InputError("FORMAT", format, nearest(format, ROBOTS))
    given, target = [log] if isinstance(log, str | Path) else log, checked_out(Path(out))
    if target.exists() and any(Path(p).exists() and target.samefile(p) for p in given):
        raise InputError("--out", target, "another file than what is read")
    with whole_file(target, force=force, ours=is_log) as part:
        found = read_log(list(given), model=model, format=format, map=map, begin=begin)
        begin(f"writing {target.name}")
        write_table(found.table, part)
    return found


def _table(
    format: str,
    paths: Sequence[Path],
    map: Path | None,
    drive: Drive,
    begin: Callable[[str], None],
) -> pd.DataFrame:
    """The sources, one after the other, as one table; several csv files become several runs."""
    if (map is None) == (format == "csv"):
        said = "a map for this csv" if map is None else f"none with {format}"
        raise InputError("--map", map, said)
    parts = []
    for number, path in enumerate(paths, start=1):
        begin(f"reading {path} ({number} of {len(paths)})")
        if format == "optiodom":
            part = read_optiodom(path, drive=drive)
        elif format == "mrclam":
            part = read_mrclam(path)
        else:
            assert map is not None
            part = read_mapped(path, map)
            if len(paths) > 1 and "run" not in part:
                part = part.assign(run=path.stem)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)

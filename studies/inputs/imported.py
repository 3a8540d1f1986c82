"""Logs of labs, in the formats that labs keep them in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.models.log.formats.lerobot import read_lerobot
from realitygap.models.log.formats.mapped import read_map
from realitygap.models.log.formats.mrclam import read_mrclam
from realitygap.models.log.formats.optiodom import read_optiodom
from realitygap.models.log.formats.rosbag import bag_topics, read_bag
from realitygap.models.log.formats.tabular import Asked, Read, read_csv_log
from realitygap.models.log.formats.trajectory import read_euroc, read_tum
from realitygap.models.log.measured import write_table
from realitygap.studies.inputs.logs import (
    AnyLog,
    Log,
    Source,
    as_log,
    checked_out,
    is_log,
    noticed,
    read_logs,
    sources,
)
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.plumbing.output import readable, whole_file
from realitygap.studies.plumbing.progress import unseen


class Format(NamedTuple):
    """How the logs of one kind are read."""

    read: Callable[[Path, Asked], Read]
    robot: str | None = None
    """Whose geometry they are read with, if no model is given; None: the e-puck's."""
    mapped: bool = False
    """Whether a map says what is what in them."""
    commands: bool = False
    """Whether they hold poses alone and need a file of commands beside them."""


FORMATS: dict[str, Format] = {
    "optiodom": Format(
        lambda path, asked: Read(read_optiodom(path, drive=asked.drive)), "optiodom"
    ),
    "mrclam": Format(lambda path, asked: Read(read_mrclam(path)), "create"),
    "csv": Format(read_csv_log, mapped=True),
    "rosbag": Format(read_bag, mapped=True),
    "mcap": Format(read_bag, mapped=True),
    "tum": Format(read_tum, mapped=True, commands=True),
    "euroc": Format(read_euroc, mapped=True, commands=True),
    "lerobot": Format(read_lerobot, mapped=True),
}
"""By name."""


def read_log(
    log: AnyLog,
    *,
    model: AnyModel = None,
    format: str | None = None,
    map: Path | str | None = None,
    commands: Path | str | None = None,
    begin: Callable[[str], None] = unseen,
) -> Log:
    """Read a measured log: check it, repair it, and count what was repaired.

    Args:
        log: A file (`.parquet`, `.csv`, `.csv.gz`), the directory of a run, or a DataFrame, with
            the columns of the measured log: t (s), x, y (m), yaw (rad), and cmd_left, cmd_right
            (rad/s) or cmd_v, cmd_omega (m/s, rad/s), a row per moment of a robot. A list of them
            becomes one log of several runs.
        model: Of the robot; the e-puck, or the robot of the format, if absent.
        format: What the files are instead: `csv` (any table), `rosbag` or `mcap` (bags of ROS),
            `tum` or `euroc` (trajectories), `lerobot` (data sets), `optiodom` (directories of
            sessions) or `mrclam` (UTIAS multi-robot directories).
        map: Columns and units of a table, or topics of a bag (TOML); guessed if absent.
        commands: Table of commands beside a `tum` or `euroc` trajectory; the map is of it.
        begin: Called with the name of each stage.

    Raises:
        InputError: it cannot be read, or is no usable log: names field, value and what is valid.
    """
    if format is None:
        if map is not None:
            raise InputError("map", map, f"a format that is read by it: {_named('mapped')}")
        begin("reading the log")
        return as_log(log, model)
    believed, source, guessed = _lab(log, model, format, map, commands, begin)
    begin("checking the log")
    measured = noticed(read_logs(source, believed.file), believed)
    return Log(measured, (source,), believed, guessed)


def _lab(
    log: AnyLog,
    model: AnyModel,
    format: str,
    map: Path | str | None,
    commands: Path | str | None,
    begin: Callable[[str], None],
) -> tuple[Model, Source, str]:
    """A lab's logs as one table that is not yet checked, its robot, and the map if guessed."""
    chosen = _chosen(format, map, commands)
    believed = Model.load(chosen.robot if model is None else model)
    given = [one.path for one in sources(log)]
    paths = [path for path in given if path is not None]
    if not paths or len(paths) != len(given):
        raise InputError("SOURCE", "no path", "files or directories of that format")
    asked = Asked(
        drive=believed.file.nominal_drive,
        fastest=None if model is None else believed.file.robot.wheel_speed_max,
        map=None if map is None else Path(map),
        commands=None if commands is None else Path(commands),
    )
    read = _read(chosen, paths, asked, begin)
    label = f"<{format} {', '.join(str(path) for path in paths)}>"
    return believed, Source(None, read.table, label), read.guessed


def import_log(
    log: Path | str | Sequence[Path | str],
    *,
    format: str,
    out: Path | str,
    model: AnyModel = None,
    map: Path | str | None = None,
    commands: Path | str | None = None,
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
        commands: As of `read_log`.
        force: Replace a log that is there.
        begin: Called with the name of each stage.

    Returns:
        The log. A map that was guessed for it (`guessed`) is written beside it, also if the log is
        refused: `log.map.toml` beside `log.parquet`.

    Raises:
        InputError: as `read_log`, or `out` cannot be written or is what is read.
    """
    _chosen(format, map, commands)
    given, target = [log] if isinstance(log, str | Path) else log, checked_out(Path(out))
    if target.exists() and any(Path(p).exists() and target.samefile(p) for p in given):
        raise InputError("--out", target, "another file than what is read")
    with whole_file(target, force=force, ours=is_log) as part:
        believed, source, guessed = _lab(list(given), model, format, map, commands, begin)
        if guessed:
            beside = guessed_map(target)
            with whole_file(beside, force=force, ours=readable(read_map)) as text:
                text.write_text(guessed, encoding="utf-8")
        begin("checking the log")
        try:
            measured = noticed(read_logs(source, believed.file), believed)
        except InputError as error:
            if not guessed:
                raise
            expected = f"{error.expected}; or another map than the one guessed, {beside} (--map)"
            raise InputError(error.field, error.got, expected) from None
        found = Log(measured, (source,), believed, guessed)
        begin(f"writing {target.name}")
        write_table(found.table, part)
    return found


def topics(bag: Path | str) -> pd.DataFrame:
    """What a bag holds: a row per topic.

    Columns `topic`, `type`, `messages` (how many) and `could_be`: the keys of a map that may name
    it.

    Args:
        bag: A bag's directory, a `.db3`, `.mcap` or `.bag`.

    Raises:
        InputError: it cannot be read, or the extra [ros] is not installed.
    """
    return bag_topics(Path(bag))


def guessed_map(out: Path | str) -> Path:
    """Where the guessed map of a log lies.

    Args:
        out: Where the log is written.
    """
    return Path(out).with_suffix(".map.toml")


def _chosen(format: str, map: Path | str | None, commands: Path | str | None) -> Format:
    """The format of a name, if what is given suits it."""
    if format not in FORMATS:
        raise InputError("FORMAT", format, nearest(format, FORMATS))
    chosen = FORMATS[format]
    if map is not None and not chosen.mapped:
        raise InputError("--map", map, f"none with {format}; it is for {_named('mapped')}")
    if commands is not None and not chosen.commands:
        expected = f"none with {format}; it is for {_named('commands')}"
        raise InputError("--commands", commands, expected)
    return chosen


def _named(quality: str) -> str:
    """The formats that have a quality."""
    return ", ".join(name for name, one in FORMATS.items() if getattr(one, quality))


def _read(
    chosen: Format, paths: Sequence[Path], asked: Asked, begin: Callable[[str], None]
) -> Read:
    """The sources, one after the other, as one table; several files become several runs."""
    parts = []
    for number, path in enumerate(paths, start=1):
        begin(f"reading {path} ({number} of {len(paths)})")
        read = chosen.read(path, asked)
        asked = replace(asked, guessed=read.guessed)
        part = read.table
        if len(paths) > 1 and "run" not in part:
            part = part.assign(run=path.stem)
        parts.append(part)
    return Read(pd.concat(parts, ignore_index=True), asked.guessed)

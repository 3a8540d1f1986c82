"""The measured log: what a lab's tracker saw and its robots were told, ready for replay.

What is not a measurement stays unread: of a run's directory only `samples.parquet` is opened.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from realitygap.embedded_sim import Drive, InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.course import courses
from realitygap.models.log.even import evened
from realitygap.models.log.named import Names, numbered
from realitygap.models.log.overridden import overridden
from realitygap.models.log.plausible import check_counting, check_units
from realitygap.models.log.schema import (
    BODY_COMMANDS,
    ENCODERS,
    KEYS,
    LS,
    POSE,
    PS,
    UNITS,
    WHEEL_COMMANDS,
    check_columns,
    coerce,
)
from realitygap.models.log.table_files import read_csv, read_parquet
from realitygap.models.log.tracker import held, repair

SAMPLES = "samples.parquet"
EXPECTED = (
    "a readable table (.parquet, .csv, .tsv, .txt or .csv.gz), or a run's directory; what else "
    "labs have is turned into one by `realitygap import`"
)
GAP_STEPS = 3.5
"""A stretch ends where rows are missing for longer than this many median steps. Our choice: two
lost rows are bridged by the last command, more are not."""


@dataclass(frozen=True, eq=False)
class MeasuredLog:
    """A validated log, sorted by run, robot and time. A segment is one robot in one run."""

    frame: pd.DataFrame
    """One row per moment; columns of `log.schema`, index 0..rows-1."""
    start: npt.NDArray[np.int64]
    """(segments + 1,) first row of each segment, and the row count."""
    segments: pd.DataFrame
    """(segments,) `run` and `robot` of each."""
    commands: FloatArray
    """(rows, 2) rad/s, left and right, valid from their row's time to the next row's."""
    tracked: npt.NDArray[np.bool_]
    """(rows,) whether the row's pose was measured and is not set aside as a tracker failure."""
    stretch: npt.NDArray[np.int64]
    """(rows,) which uninterrupted stretch the row belongs to; nothing is concluded across two."""
    held: npt.NDArray[np.bool_]
    """(rows,) whether the row repeated the pose before, as slow trackers do, and lost it."""
    step: float
    """s, median time between rows."""
    recorder: str
    """What recorded it, where its file says so."""
    notes: tuple[str, ...]
    """Repairs and omissions, counted, in plain words."""
    jitter: float = 0.0
    """s, standard deviation of stamps about even times, which were taken instead."""
    headed: bool = True
    """Whether the tracker told headings; else they are courses (`log.course`)."""
    names: Names = field(default_factory=Names)
    """What robots are called; `robot` of the frame and the segments is a number all the same."""

    @property
    def t(self) -> FloatArray:
        """(rows,) s."""
        return self.frame["t"].to_numpy(dtype=np.float64)

    @property
    def poses(self) -> FloatArray:
        """(rows, 3) measured x, y (m) and yaw (rad); NaN where not tracked."""
        return np.ascontiguousarray(self.frame[list(POSE)].to_numpy(dtype=np.float64))

    @cached_property
    def rolling(self) -> FloatArray | None:
        """(segments, 2) rad/s at which wheels turn as segments begin, where encoders tell."""
        if not set(ENCODERS) <= set(self.frame.columns):
            return None
        first = self.frame[list(ENCODERS)].to_numpy(dtype=np.float64)[self.start[:-1]]
        return np.asarray(np.nan_to_num(first))

    @property
    def robots(self) -> npt.NDArray[Any]:
        """(rows,) whose row it is: names where the log has them, else numbers."""
        numbers = self.frame["robot"]
        return (numbers.map(self.names.key) if self.names else numbers).to_numpy()

    @property
    def segment(self) -> npt.NDArray[np.int64]:
        """(rows,) segment of each row."""
        return np.repeat(np.arange(len(self.segments)), np.diff(self.start))


def read_log(source: Path | str, *, drive: Drive, fastest: float | None = None) -> MeasuredLog:
    """Read a log from a Parquet or CSV file, or from the directory of a run.

    Args:
        source: `.parquet`, `.csv`, `.tsv`, `.txt`, `.csv.gz`, or a directory that holds
            `samples.parquet`.
        drive: The nominal geometry, which turns body commands into wheel speeds.
        fastest: rad/s, most a wheel of this robot turns; commands far beyond are refused.

    Raises:
        InputError: the file cannot be read, or does not hold a usable log.
    """
    return make_log(read_table(Path(source)), drive=drive, fastest=fastest)


def read_table(path: Path) -> pd.DataFrame:
    """The raw table of a log file.

    Raises:
        InputError: there is no such file, or it is not a table.
    """
    if os.path.isdir(path):  # unlike Path.is_dir, false where one may not look
        path = path / SAMPLES
        if not os.path.exists(path):
            raise InputError(
                str(path.parent), f"a directory without {SAMPLES}", "a run with samples"
            )
    kind = "".join(path.suffixes[-2:]) if path.suffix == ".gz" else path.suffix
    if kind == ".parquet":
        return read_parquet(path, EXPECTED)
    if kind in (".csv", ".csv.gz", ".tsv", ".txt"):
        return read_csv(path, EXPECTED, packed=kind == ".csv.gz")
    raise InputError("log", path, EXPECTED)


def make_log(
    frame: pd.DataFrame,
    *,
    drive: Drive,
    fastest: float | None = None,
    known: Mapping[str, int] | None = None,
) -> MeasuredLog:
    """A measured log from a table with the columns of `log.schema`; arguments as `read_log`.

    `known` are the numbers of robots that a model has by name.

    Raises:
        InputError: as `read_log`.
    """
    notes = [f"column {name} is not read" for name in check_columns(list(frame.columns))]
    robots, called = numbered(frame["robot"], known)
    table = coerce(frame.assign(robot=robots, **({} if "yaw" in frame else {"yaw": np.nan})))
    if "run" not in table:
        table = table.assign(run="run")
    repeated = table.duplicated()
    if repeated.any():
        notes.append(f"{repeated.sum()} repeated rows dropped")
        table = table[~repeated]
    # sorted before rows are dropped, so that a dropped row breaks its own robot's track
    table = table.iloc[np.lexsort((table["robot"], table["run"]))]
    usable, dropped = _without_holes(table)
    if dropped.any():
        notes.append(f"{dropped.sum()} rows without time or command dropped")
    usable, dropped_before = usable.reset_index(drop=True), _after(dropped)
    start, segments = _segments(usable)
    t = usable["t"].to_numpy()
    names = [f"robot {called[r]} in run {run}" for run, r in segments.itertuples(index=False)]
    _check_time(t, start, names)
    steps = np.diff(t)
    inside = np.ones(len(steps), dtype=bool)
    inside[start[1:-1] - 1] = False
    if not inside.any():
        raise InputError("log", f"{len(usable)} rows", "at least two moments of one robot")
    step = float(np.median(steps[inside]))
    segment = np.repeat(np.arange(len(segments)), np.diff(start))
    commands = wheel_commands(usable, drive)
    headed = bool(usable["yaw"].notna().any())
    if not headed:
        usable = _by_course(usable, commands, segment, notes)
    poses = usable[list(POSE)].to_numpy(dtype=np.float64)
    jitter, even = 0.0, evened(t, poses, commands, start, drive)
    if even is not None:
        jitter = float(np.std(t - even))
        notes.append(f"stamps jitter by {1e3 * jitter:.2g} ms where the motion is even: made even")
        usable["t"] = t = even
        steps = np.diff(t)
    other = np.zeros(len(t), dtype=bool)
    if set(ENCODERS) <= set(usable.columns):
        wheels = usable[list(ENCODERS)].to_numpy(dtype=np.float64)
        check_counting(wheels, poses, start)
        other = overridden(t, commands, wheels, start)
    if other.any():
        seconds = float(np.append(steps, step)[other].clip(0.0, GAP_STEPS * step).sum())
        notes.append(
            f"{seconds:.3g} s set aside: by the encoders the wheels did not follow the log's "
            "commands at all, as in a robot driven by hand or switched off"
        )
    breaks = ~inside | (steps > GAP_STEPS * step) | dropped_before[1:]
    gaps = int((inside & breaks).sum())
    if gaps:
        notes.append(f"{gaps} gaps in time: nothing is replayed across them")
    check_units(t, poses, commands, start, drive=drive, names=names, fastest=fastest)
    breaks |= np.diff(other.astype(np.int8)) != 0
    stretch = np.concatenate([[0], np.cumsum(breaks)])
    again = held(poses, np.any(commands != 0.0, axis=1), segment)
    if again.any():
        notes.append(f"{again.sum()} rows repeat a pose, as slow trackers do: each is used once")
        usable.loc[again, list(POSE)] = np.nan
        poses = usable[list(POSE)].to_numpy(dtype=np.float64)
    speed = float(np.abs(0.5 * commands @ np.array(drive.wheel_radius)).max())
    track = repair(poses, t, stretch, segment, names, speed, headed=headed)
    return MeasuredLog(
        frame=usable,
        start=start,
        segments=segments,
        commands=commands,
        tracked=track.tracked & ~other,
        stretch=stretch + np.cumsum(track.jumps),
        held=again,
        step=step,
        recorder=str(frame.attrs.get("recorder", "")),
        notes=(*notes, *track.notes),
        jitter=jitter,
        headed=headed,
        names=called,
    )


def _by_course(
    table: pd.DataFrame, commands: FloatArray, segment: npt.NDArray[np.int64], notes: list[str]
) -> pd.DataFrame:
    """The table with headings taken from where robots go, and a note of how well."""
    places = table[["x", "y"]].to_numpy(dtype=np.float64)
    yaw, noise = courses(table["t"].to_numpy(dtype=np.float64), places, commands, segment)
    if np.isnan(yaw).all():
        raise InputError("yaw", "nothing", "numbers, or robots that move clearly")
    notes.append(
        f"no yaw: taken from where robots go, with noise of {noise:.2g} rad; "
        f"{np.isnan(yaw).sum()} rows are too slow, or too soon after a reversal; "
        "where a marker is mounted cannot show, and infrared and light are left out"
    )
    return table.assign(yaw=yaw).drop(columns=[name for name in (*PS, *LS) if name in table])


def wheel_commands(frame: pd.DataFrame, drive: Drive) -> FloatArray:
    """(rows, 2) commanded wheel speeds (rad/s); body commands through the nominal geometry."""
    if set(WHEEL_COMMANDS) <= set(frame.columns):
        return np.ascontiguousarray(frame[list(WHEEL_COMMANDS)].to_numpy())
    v, omega = (frame[name].to_numpy() for name in BODY_COMMANDS)
    turn = 0.5 * drive.axle * omega
    left, right = drive.wheel_radius
    return np.column_stack([(v - turn) / left, (v + turn) / right])


def _without_holes(table: pd.DataFrame) -> tuple[pd.DataFrame, npt.NDArray[np.bool_]]:
    """The rows that have a time and a command, and which rows of the table do not."""
    needed = ["t", *(n for n in (*WHEEL_COMMANDS, *BODY_COMMANDS) if n in table)]
    hole = table[needed].isna().any(axis=1).to_numpy()
    if len(table) == 0 or hole.all():
        raise InputError("log", f"{len(table)} rows, none with time and command", "measured rows")
    return table[~hole], hole


def _after(dropped: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """For each kept row, whether the row before it was dropped."""
    before = np.concatenate([[False], dropped[:-1]])
    return before[~dropped]


def _segments(frame: pd.DataFrame) -> tuple[npt.NDArray[np.int64], pd.DataFrame]:
    """First rows and keys of each robot in each run, of a table sorted by both."""
    keys = frame[list(KEYS)]
    new = (keys != keys.shift()).any(axis=1).to_numpy()
    first = np.flatnonzero(new)
    return np.append(first, len(frame)), keys.iloc[first].reset_index(drop=True)


def _check_time(t: FloatArray, start: npt.NDArray[np.int64], names: list[str]) -> None:
    """Refuse time that does not increase within a robot's run, and say what it looks like."""
    step = np.diff(t)
    step[start[1:-1] - 1] = np.inf
    wrong = np.flatnonzero(step <= 0)
    if not len(wrong):
        return
    row = int(wrong[0])
    segment = int(np.searchsorted(start, row, side="right")) - 1
    first, last = start[segment], start[segment + 1]
    where = f"t of {names[segment]}"
    values, count = np.unique(t[first:last], return_counts=True)
    twice = int((count > 1).sum())
    if len(values) == 1:
        raise InputError(
            where, f"{values[0]:g} s in all {last - first} rows", "time that increases"
        )
    if 2 * twice > len(values):
        seen = f"{twice} of {len(values)} times more than once, with different rows"
        raise InputError(where, seen, "one robot per id: give two robots two numbers")
    inside = (wrong >= first) & (wrong < last)
    seen = f"{t[row + 1]:g} s after {t[row]:g} s, and {int(inside.sum()) - 1} more such rows"
    raise InputError(where, seen, "increasing time: sort the rows by t, keep one row per time")


def write_table(frame: pd.DataFrame, path: Path, units: Mapping[str, str] = UNITS) -> None:
    """Write a table as Parquet, with each column's unit in its field's metadata, or as CSV.

    Raises:
        InputError: the name ends in neither.
    """
    if path.suffix == ".csv":
        frame.to_csv(path, index=False)
    elif path.suffix == ".parquet":
        table = pa.Table.from_pandas(frame, preserve_index=False)
        fields = [
            field.with_metadata({"unit": units.get(field.name, "")}) for field in table.schema
        ]
        pq.write_table(table.cast(pa.schema(fields, metadata=table.schema.metadata)), path)
    else:
        raise InputError("--out", path.name, "a file ending in .parquet or .csv")

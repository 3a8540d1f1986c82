"""Measured logs as every command takes them: files, runs' directories, or tables in memory."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import pandas as pd
from markupsafe import escape

from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.assumed import unlike
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import (
    EXPECTED,
    SAMPLES,
    MeasuredLog,
    make_log,
    read_table,
    write_table,
)
from realitygap.models.log.opened import opened
from realitygap.models.log.schema import BODY_COMMANDS, WHEEL_COMMANDS
from realitygap.models.log.table_files import MOST_BYTES
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.pages.notebook import html_table, new_axes
from realitygap.studies.plumbing.output import Ours, whole_file
from realitygap.studies.plumbing.provenance import file_read

if TYPE_CHECKING:
    from matplotlib.axes import Axes

IN_MEMORY = "<table>"
"""What a table in memory is called where a file's path would stand."""
PART = 2**20
"""bytes read at once."""


@dataclass(frozen=True, eq=False)
class Source:
    """One log as it was given."""

    path: Path | None
    """A file, or the directory of a run; None: a table in memory."""
    frame: pd.DataFrame | None = None
    """The table in memory."""
    label: str = IN_MEMORY
    """What the table in memory is called."""

    @property
    def name(self) -> str:
        """As messages call it."""
        return self.label if self.path is None else str(self.path)

    @property
    def typed(self) -> Path | str:
        """What a user would type; a table in memory cannot be typed, and its label says so."""
        return self.path or self.label

    @property
    def file(self) -> Path | None:
        """The file that is read."""
        if self.path is None or not self.path.is_dir():
            return self.path
        return self.path / SAMPLES

    def table(self) -> pd.DataFrame:
        """The table as it was given.

        Raises:
            InputError: as `log.measured.read_table`.
        """
        if self.frame is not None:
            return self.frame
        assert self.path is not None
        return read_table(self.path)

    def content(self, field: str | None = None) -> Iterator[bytes]:
        """The bytes that its SHA-256 is of; of a table in memory its columns and its rows' hashes.

        Raises:
            InputError: as `log.opened.opened`; `field` is what to call the log there.
        """
        if self.frame is not None:
            yield repr([str(name) for name in self.frame.columns]).encode()
            rows = pd.util.hash_pandas_object(self.frame, index=False)
            yield rows.to_numpy(dtype=np.uint64).tobytes()
        elif self.file is not None:
            expected = "a measured log" if field is None else EXPECTED
            with opened(self.file, expected, most=MOST_BYTES, field=field) as file:
                while part := file.read(PART):
                    yield part

    def entry(self, option: str) -> dict[str, str]:
        """Of `inputs`: who asked for it, what it is called, and what was in it."""
        if self.file is not None:
            return file_read(option, self.file)
        return {"option": option, "file": self.label, "sha256": log_hash([self])}


@dataclass(frozen=True, eq=False, repr=False)
class Log:
    """A measured log, checked and repaired: of one or several robots and runs.

    `read_log` reads one. Every function that takes a log also takes what `read_log` takes.
    """

    measured: MeasuredLog
    """What replay and diagnosis read."""
    sources: tuple[Source, ...]
    """Where it comes from."""
    model: Model
    """Whose geometry turned commands of the body into wheel speeds."""
    guessed: str = ""
    """The map it was read by (TOML), where that was guessed; empty: it was not."""

    @property
    def table(self) -> pd.DataFrame:
        """One row per moment of a robot, in SI units: the columns of the measured log."""
        guessed = [] if self.measured.headed else ["yaw"]
        return self.measured.frame.drop(columns=guessed).assign(robot=self.measured.robots)

    @property
    def robots(self) -> tuple[int | str, ...]:
        """Numbers, in order, or names where the log has them."""
        numbers = sorted({int(robot) for robot in self.measured.segments["robot"]})
        return tuple(self.measured.names.key(robot) for robot in numbers)

    @property
    def runs(self) -> tuple[str, ...]:
        """Names, in order."""
        return tuple(sorted({str(run) for run in self.measured.segments["run"]}))

    @property
    def step(self) -> float:
        """s: median time between two rows of a robot."""
        return self.measured.step

    @property
    def notes(self) -> tuple[str, ...]:
        """What was repaired or left out, counted, in words."""
        return self.measured.notes

    @property
    def size(self) -> str:
        """How long it is, in words."""
        runs = self.measured.segments["run"].nunique()
        some = ((len(self.table), "row"), (runs, "run"), (len(self.robots), "robot"))
        told = ", ".join(f"{n} {what}{'s' * (n != 1)}" for n, what in some)
        return f"{told}, a row each {self.step:.4g} s"

    def write(self, out: Path | str, *, force: bool = False) -> None:
        """Write the table as a file.

        Args:
            out: `.parquet`, with units in the fields' metadata, or `.csv`.
            force: Replace a log that is there.

        Raises:
            InputError: `out` has another ending, is there already or cannot be written.
        """
        with whole_file(checked_out(Path(out)), force=force, ours=is_log) as part:
            write_table(self.table, part)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw where the robots were seen, a line each.

        Args:
            axes: To draw into; new ones if absent.
        """
        axes = new_axes(axes)
        for color, (robot, track) in enumerate(self.table.groupby("robot", sort=False)):
            for k, (_, one) in enumerate(track.groupby("run", sort=False)):
                label = f"robot {robot}" if k == 0 else None
                axes.plot(one["x"], one["y"], linewidth=0.9, label=label, color=f"C{color}")
        axes.set(xlabel="x (m)", ylabel="y (m)")
        axes.set_aspect("equal", adjustable="datalim")
        axes.legend()
        return axes

    def _repr_html_(self) -> str:
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        where = escape(", ".join(one.name for one in self.sources))
        return f"<div><h4>Log {where}</h4><p>{self.size}</p>{notes}{html_table(self.table)}</div>"

    def __repr__(self) -> str:
        where = ", ".join(one.name for one in self.sources)
        notes = "".join(f"\n  {note}" for note in self.notes)
        return f"<Log {where}: {self.size}>{notes}"


OneLog: TypeAlias = Path | str | pd.DataFrame | Source | Log
"""A path, a run's directory, a table, or a log that was read."""
AnyLog: TypeAlias = OneLog | Sequence[OneLog]
"""One log or several, which together are one."""


def sources(given: AnyLog) -> tuple[Source, ...]:
    """The single logs in what was given."""
    if isinstance(given, Log):
        return given.sources
    if isinstance(given, Source):
        return (given,)
    if isinstance(given, pd.DataFrame):
        return (Source(None, given),)
    if isinstance(given, str | Path):
        return (Source(Path(given)),)
    if not isinstance(given, Sequence):
        raise InputError("log", repr(given), f"{EXPECTED}, a DataFrame, or a list of them")
    return tuple(one for each in given for one in sources(each))


def as_log(given: AnyLog, model: AnyModel = None) -> Log:
    """What was given as one log, judged by a model; one that was read keeps its own.

    Raises:
        InputError: as `read_logs`, or the model cannot be used.
    """
    if isinstance(given, Log) and (model is None or model is given.model):
        return given
    chosen, single = Model.load(model), sources(given)
    return Log(noticed(read_logs(single, chosen.file), chosen), single, chosen)


def noticed(measured: MeasuredLog, chosen: Model) -> MeasuredLog:
    """The log, with a note first if nobody asked for a model and the one assumed cannot be it."""
    said = unlike(measured, chosen.file) if chosen.typed is None else ""
    return replace(measured, notes=(said, *measured.notes)) if said else measured


def read_logs(given: AnyLog, model: ModelFile) -> MeasuredLog:
    """One measured log out of one or several; robots of one id are one robot in all of them.

    Raises:
        InputError: as `log.measured.read_log`, a log is given twice, or their commands differ.
    """
    single = sources(given)
    if not single:
        raise InputError("log", "nothing", EXPECTED)
    tables = [one.table() for one in single]
    known: dict[str, Source] = {}
    for one in single if len(single) > 1 else ():
        digest = log_hash([one])
        if digest in known:
            raise InputError(one.name, f"the same log as {known[digest].name}", "each log once")
        known[digest] = one
    first = _commands(tables[0])
    for one, table in zip(single, tables, strict=True):
        if _commands(table) != first:
            said = " and ".join(_commands(table)) or "no commands"
            raise InputError(one.name, said, f"{' and '.join(first)}, as in {single[0].name}")
    if len(tables) > 1:
        for k, table in enumerate(tables):
            run = table["run"].astype(str) if "run" in table else "run"
            tables[k] = table.assign(run=f"{k + 1}/" + run)
    # commands become wheel speeds as in the lab: an extension tells of the robots
    drive, fastest = model.nominal_drive, model.robot.wheel_speed_max
    called = {} if model.extension is None else model.extension.names
    return make_log(
        pd.concat(tables, ignore_index=True), drive=drive, fastest=fastest, known=called
    )


def _commands(table: pd.DataFrame) -> tuple[str, ...]:
    """Which pair of commands a log has."""
    return tuple(name for name in (*WHEEL_COMMANDS, *BODY_COMMANDS) if name in table)


def log_hash(given: AnyLog, field: str | None = None) -> str:
    """SHA-256 over the content of logs, in order; `field` is what to call them in a refusal."""
    digest = hashlib.sha256()
    for one in sources(given):
        for part in one.content(field):
            digest.update(part)
    return digest.hexdigest()


def checked_out(out: Path) -> Path:
    """A path that a table can be written to.

    Raises:
        InputError: its ending is another.
    """
    if out.suffix not in (".parquet", ".csv"):
        raise InputError("--out", out.name, "a file ending in .parquet or .csv")
    return out


def _is_log(path: Path) -> bool:
    try:
        return {"run", "robot", "t", "x", "y"} <= set(read_table(path).columns)
    except InputError:
        return False


is_log: Ours = _is_log
"""Whether a file is a table as `Log.write` writes it."""

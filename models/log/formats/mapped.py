"""Any lab's tables, read by a map: which column is what, and in which unit.

    [columns]                 # measured-log column = column of the file, or a table with its unit
    t = { from = "stamp", unit = "ms" }
    x = { from = "pos_x", unit = "mm" }
    y = { from = "pos_y", unit = "mm" }
    yaw = { quaternion = ["qx", "qy", "qz", "qw"] }
    cmd_left = { from = "v_left", unit = "m/s" }    # of the rim
    cmd_right = { from = "v_right", unit = "m/s" }
    wheel_left = { from = "ticks_l", unit = "ticks", per_turn = 2048, wraps = 65536 }
    wheel_right = { from = "ticks_r", unit = "ticks", per_turn = 2048, wraps = 65536 }
    robot = "name"            # absent: one robot, number 0

    [[files]]                 # further files, joined on time
    file = "tracker.csv"      # relative to the map
    columns = { t = { from = "time", unit = "iso" }, x = "px", y = "py", yaw = "heading" }

`[poses]` with `file` and `t` is short for a further file from which x, y and yaw come, named as in
`[columns]`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
from pydantic import Field, model_validator

from realitygap.embedded_sim import Drive, InputError
from realitygap.embedded_sim.errors import nearest
from realitygap.models.log.files import Refused, Table, checked
from realitygap.models.log.formats.streams import merged, with_speeds
from realitygap.models.log.formats.units import (
    ANGLES,
    ISO,
    SCALES,
    TURNS,
    heading,
    iso_seconds,
    numbers,
    units_of,
)
from realitygap.models.log.measured import read_table
from realitygap.models.log.opened import toml_values
from realitygap.models.log.schema import KEYS, POSE, UNITS

__all__ = ["SCALES", "File", "Map", "Origin", "Poses", "read_map"]

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class Origin(Table):
    """Where a column comes from: a column of the file, or four for a yaw."""

    name: Annotated[str | None, Field(alias="from")] = None
    quaternion: tuple[str, str, str, str] | None = None
    """Columns x, y, z, w."""
    unit: str | None = None
    scale: Annotated[float, Field(allow_inf_nan=False)] = 1.0
    """Multiplies after the unit: -1 turns a clockwise yaw round."""
    per_turn: Positive | None = None
    """Ticks of a whole turn of the wheel."""
    wraps: Positive | None = None
    """Count, in the column's unit, after which a wheel's angle begins anew."""

    @model_validator(mode="after")
    def _one(self) -> Origin:
        """Refuse what says nothing, or two things."""
        if self.name is None and self.quaternion is None:
            raise Refused("from", "nothing", "a column of the file, or quaternion = [four of them]")
        if self.quaternion is not None and (self.name is not None or self.unit is not None):
            raise Refused("quaternion", "also from or unit", "the four columns alone")
        if self.unit == "ticks" and self.per_turn is None:
            raise Refused("per_turn", "nothing", "ticks of a whole turn of the wheel")
        if self.per_turn is not None and self.unit != "ticks":
            raise Refused("per_turn", f"{self.per_turn:g}", 'only with unit = "ticks"')
        if self.wraps is not None and self.unit not in TURNS:
            raise Refused("wraps", f"{self.wraps:g}", f"only with a unit of {', '.join(TURNS)}")
        return self


class Poses(Table):
    """A second file with the poses."""

    file: Annotated[Path, Field(strict=False)]
    t: Origin | str


class File(Table):
    """A further file."""

    file: Annotated[Path, Field(strict=False)]
    columns: dict[str, Origin | str]


class Map(Table):
    """A whole map."""

    columns: dict[str, Origin | str]
    poses: Poses | None = None
    files: tuple[File, ...] = ()

    def check(self, name: str) -> None:
        """Refuse columns and units that a measured log does not have.

        Args:
            name: Of the map's file.

        Raises:
            InputError: the first of them.
        """
        _check(self.columns, f"{name}: columns")
        if self.poses is not None:
            _check({"t": self.poses.t}, f"{name}: poses")
        for number, one in enumerate(self.files):
            _check(one.columns, f"{name}: files.{number}.columns")
            if "t" not in one.columns:
                raise InputError(f"{name}: files.{number}.columns", "no t", "the file's time")


def read_map(path: Path) -> Map:
    """Read and check a map.

    Raises:
        InputError: no such file, broken TOML, unknown keys, columns or units.
    """
    found = checked(Map, toml_values(path, "a map (TOML)", field="--map"), path, "a map")
    found.check(path.name)
    return found


def by_map(
    raw: pd.DataFrame,
    chosen: Map,
    *,
    path: Path,
    folder: Path,
    name: str,
    drive: Drive,
) -> pd.DataFrame:
    """A table of a lab as a measured-log table.

    Args:
        raw: As it was read.
        chosen: Its map.
        path: Where it was read from.
        folder: What further files are relative to.
        name: Of the map, in a refusal.
        drive: The nominal geometry, which turns speeds of a rim into a wheel's.

    Raises:
        InputError: a file cannot be used, or a column is missing.
    """
    asked = dict(chosen.columns)
    further = [(folder / one.file, dict(one.columns)) for one in chosen.files]
    tables = {one: read_table(one) for one in dict.fromkeys(one for one, _ in further)}
    if chosen.poses is not None:
        place = folder / chosen.poses.file
        seen = tables.setdefault(place, read_table(place))
        own = {n: asked.pop(n) for n in POSE if n in asked}
        keys = {k: asked[k] for k in KEYS if k in asked and _source(asked[k]).name in seen}
        further.append((place, {"t": chosen.poses.t, **own, **keys}))
    first = _columns(raw, asked, path, drive)
    if not further:
        first = with_speeds(first)
        return first if "robot" in first else first.assign(robot=0)
    others = [_columns(tables[place], columns, place, drive) for place, columns in further]
    table = merged([first, *others], f"{name}: columns")
    return table if "robot" in table else table.assign(robot=0)


def _columns(
    raw: pd.DataFrame, wanted: Mapping[str, Origin | str], path: Path, drive: Drive
) -> pd.DataFrame:
    """The wanted columns, in SI units; angles of wheels by the names of `units.ANGLES`."""
    for name, given in wanted.items():
        source = _source(given)
        for column in source.quaternion or (source.name,):
            if column not in raw:
                known = nearest(str(column), map(str, raw.columns))
                raise InputError(f"{path.name}: {name}", f"no column {column}", known)
    result = {}
    keys = [_source(wanted[key]).name for key in KEYS if key in wanted]
    for name, given in wanted.items():
        source = _source(given)
        turned = source.unit in TURNS and name in ANGLES
        values = _values(raw, name, source, path, drive)
        if source.wraps is not None and source.scale:
            period = abs(source.wraps * _scale(name, source, drive))
            values = _unwrapped(values, period, raw, keys)
        result[ANGLES[name] if turned else name] = values
    return pd.DataFrame(result)


def _values(
    raw: pd.DataFrame, name: str, source: Origin, path: Path, drive: Drive
) -> pd.Series[float]:
    """One column, in its SI unit."""
    if source.quaternion is not None:
        field = f"{path.name}: quaternion of {name}"
        parts = [numbers(raw[one], f"{path.name}: {one}").to_numpy() for one in source.quaternion]
        return pd.Series(heading(np.column_stack(parts), field) * source.scale, index=raw.index)
    field = f"{path.name}: {source.name}"
    values = raw[source.name]
    if source.unit == ISO:
        return iso_seconds(values, field) * source.scale
    scale = source.scale if source.unit is None else _scale(name, source, drive)
    if scale == 1.0 and UNITS[name] in ("", "bool"):
        return values
    expected = 'numbers, or unit = "iso" for dates' if name == "t" else "numbers"
    with np.errstate(over="ignore"):  # infinite numbers are refused as such
        return numbers(values, field, expected) * scale


def _unwrapped(
    angles: pd.Series[float], period: float, raw: pd.DataFrame, keys: list[str | None]
) -> pd.Series[float]:
    """A wheel's angles that go on where their count began anew, each robot's by itself."""
    known = angles[np.isfinite(angles)]
    groups = known.groupby([raw.loc[known.index, key] for key in keys]) if keys else [((), known)]
    parts = [
        pd.Series(np.unwrap(part.to_numpy(), period=period), index=part.index) for _, part in groups
    ]
    return pd.concat(parts).reindex(angles.index) if parts else angles


def _source(given: Origin | str) -> Origin:
    """A plain name stands for a column in the log's own unit."""
    return given if isinstance(given, Origin) else Origin.model_validate({"from": given})


def _scale(name: str, source: Origin, drive: Drive) -> float:
    """What to multiply a column with a unit by."""
    assert source.unit is not None
    return units_of(name, drive)[source.unit] * source.scale / (source.per_turn or 1.0)


def _check(columns: Mapping[str, Origin | str], where: str) -> None:
    for name, given in columns.items():
        if name not in UNITS:
            raise InputError(f"{where}.{name}", "an unknown column", nearest(name, UNITS))
        source, units = _source(given), units_of(name, Drive())
        if source.quaternion is not None and UNITS[name] != "rad":
            raise InputError(f"{where}.{name}.quaternion", "four columns", "only for a yaw")
        if source.unit is not None and source.unit not in units:
            expected = nearest(source.unit, units) if units else "no unit for this column"
            raise InputError(f"{where}.{name}.unit", source.unit, expected)

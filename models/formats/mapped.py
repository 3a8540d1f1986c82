"""Any lab's CSV, read by a map: which column is what, and in which unit.

    [columns]                 # measured-log column = column of the file, or a table with its unit
    t = { from = "stamp", unit = "ms" }
    x = { from = "pos_x", unit = "mm" }
    y = { from = "pos_y", unit = "mm" }
    yaw = { from = "heading", unit = "deg" }
    cmd_v = "v"
    cmd_omega = "w"
    robot = "id"              # absent: one robot, number 0

    [poses]                   # only if poses are in a second file: its columns then come from there
    file = "tracker.csv"      # relative to the map
    t = { from = "time", unit = "s" }

With `[poses]` the columns x, y and yaw are read from that file and joined to the commands on time
(`models.formats.joined`).
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import Field

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.errors import nearest
from realitygap.models.files import Table, checked
from realitygap.models.formats.joined import join, latest, series
from realitygap.models.log import read_table
from realitygap.models.opened import parsing, toml_values
from realitygap.models.schema import BODY_COMMANDS, POSE, UNITS, WHEEL_COMMANDS
from realitygap.models.unit_mistakes import EPUCK_STEPS

SCALES: dict[str, dict[str, float]] = {
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "rad": {"rad": 1.0, "deg": np.pi / 180},
    "m/s": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3},
    "rad/s": {
        "rad/s": 1.0,
        "deg/s": np.pi / 180,
        "rpm": 2 * np.pi / 60,
        "steps/s": 2 * np.pi / EPUCK_STEPS,
    },
}
"""Units a column may be in, by the log's own unit, and what to multiply by. An e-puck's steps per
second are a wheel's alone."""


class Source(Table):
    """Where a column comes from."""

    name: Annotated[str, Field(alias="from")]
    unit: str | None = None
    scale: Annotated[float, Field(allow_inf_nan=False)] = 1.0
    """Multiplies after the unit: -1 turns a clockwise yaw round."""


class Poses(Table):
    """A second file with the poses."""

    file: Annotated[Path, Field(strict=False)]
    t: Source | str


class Map(Table):
    """A whole map."""

    columns: dict[str, Source | str]
    poses: Poses | None = None


def read_map(path: Path) -> Map:
    """Read and check a map.

    Raises:
        InputError: no such file, broken TOML, unknown keys, columns or units.
    """
    found = checked(Map, toml_values(path, "a map (TOML)", field="--map"), path, "a map")
    for name, source in found.columns.items():
        if name not in UNITS:
            raise InputError(
                f"{path.name}: columns.{name}", "an unknown column", nearest(name, UNITS)
            )
        _scale(name, _source(source), path)
    if found.poses is not None:
        _scale("t", _source(found.poses.t), path)
    return found


def read_mapped(path: Path, map_path: Path) -> pd.DataFrame:
    """A CSV (or Parquet) file as a measured-log table.

    Raises:
        InputError: the file or the map cannot be used, or a column is missing.
    """
    chosen = read_map(map_path)
    raw = read_table(path)
    if chosen.poses is None:
        return _columns(raw, chosen.columns, path, map_path).assign(
            **({} if "robot" in chosen.columns else {"robot": 0})
        )
    told = {name: source for name, source in chosen.columns.items() if name not in POSE}
    seen = {
        name: source for name, source in chosen.columns.items() if name in (*POSE, "robot", "run")
    }
    pose_path = map_path.parent / chosen.poses.file
    raw_poses = read_table(pose_path)
    present = {n: s for n, s in seen.items() if n in POSE or _source(s).name in raw_poses}
    poses = _columns(raw_poses, {"t": chosen.poses.t, **present}, pose_path, map_path)
    commands = _columns(raw, told, path, map_path)
    return _joined(commands, poses, map_path)


def _joined(commands: pd.DataFrame, poses: pd.DataFrame, map_path: Path) -> pd.DataFrame:
    """Commands and poses of each robot and run on common times."""
    pair = next((list(p) for p in (WHEEL_COMMANDS, BODY_COMMANDS) if set(p) <= set(commands)), None)
    if pair is None or not set(POSE) <= set(poses):
        raise InputError(f"{map_path.name}: columns", "no pair of commands or no pose", "both")
    if "robot" not in commands:
        commands = commands.assign(robot=0)
    keys = [k for k in ("run", "robot") if k in commands and k in poses]
    groups = commands.groupby(keys) if keys else [((), commands)]
    parts = []
    for key, part in groups:
        there = poses
        for name, value in zip(keys, key if isinstance(key, tuple) else (key,), strict=True):
            there = there[there[name] == value]
        told, seen = latest(*series(part, "t", pair)), latest(*series(there, "t", list(POSE)))
        if len(told[0]) < 2 or len(seen[0]) < 2:  # a robot that was never told or never seen
            continue
        t, held, at = join(told[0], told[1], seen[0], seen[1])
        columns: dict[str, Any] = {
            name: part[name].iloc[0] for name in ("run", "robot") if name in part
        }
        columns |= {"t": t} | dict(zip(POSE, at.T, strict=True))
        parts.append(pd.DataFrame(columns | dict(zip(pair, held.T, strict=True))))
    if not parts:
        raise InputError("source", "no robot with both commands and poses", "rows of each")
    return pd.concat(parts, ignore_index=True)


def _columns(
    raw: pd.DataFrame, wanted: dict[str, Source | str], path: Path, map_path: Path
) -> pd.DataFrame:
    """The wanted columns, in SI units."""
    result = {}
    for name, given in wanted.items():
        source = _source(given)
        if source.name not in raw:
            raise InputError(
                f"{path.name}: {name}",
                f"no column {source.name}",
                nearest(source.name, map(str, raw.columns)),
            )
        values = raw[source.name]
        scale = _scale(name, source, map_path)
        if scale != 1.0 or UNITS[name] not in ("", "bool"):
            with parsing(f"{path.name}: {source.name}", "numbers"):
                numbers = pd.to_numeric(values, errors="coerce").astype(float)
            if len(wrong := values[numbers.isna() & values.notna()]):
                raise InputError(f"{path.name}: {source.name}", wrong.iloc[0], "numbers")
            with np.errstate(over="ignore"):  # infinite numbers are refused as such
                values = numbers * scale
        result[name] = values
    return pd.DataFrame(result)


def _source(given: Source | str) -> Source:
    """A plain name stands for a column in the log's own unit."""
    return given if isinstance(given, Source) else Source.model_validate({"from": given})


def _scale(name: str, source: Source, map_path: Path) -> float:
    """What to multiply a column by."""
    units = SCALES.get(UNITS[name], {})
    if name == "cmd_omega":
        units = {unit: scale for unit, scale in units.items() if unit != "steps/s"}
    if source.unit is None:
        return source.scale
    if source.unit not in units:
        raise InputError(
            f"{map_path.name}: columns.{name}.unit",
            source.unit,
            nearest(source.unit, units) if units else "no unit for this column",
        )
    return units[source.unit] * source.scale

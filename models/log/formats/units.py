"""Units that a lab's columns may be in, and what turns them into the log's own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim import Drive, InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.agreement import EPUCK_STEPS
from realitygap.models.log.opened import parsing
from realitygap.models.log.schema import ENCODERS, UNITS, WHEEL_COMMANDS

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
ISO = "iso"
"""Unit of a time that is a date and a time of day as text, by ISO 8601; UTC where it does not say
another zone."""
TURNS: dict[str, float] = {"rad": 1.0, "deg": np.pi / 180, "turns": 2 * np.pi, "ticks": 2 * np.pi}
"""Units of a wheel's angle, and rad in one; of ticks, in as many as make a turn."""
ANGLES = dict(zip(ENCODERS, ("angle_left", "angle_right"), strict=True))
"""What the angle of a wheel is called until it has become a speed."""
WHEELS = (*WHEEL_COMMANDS, *ENCODERS)


def units_of(name: str, drive: Drive) -> Mapping[str, float]:
    """Every unit that a column may be in, and what to multiply by; of ticks a whole turn's rad.

    Args:
        name: Of the measured log.
        drive: The nominal geometry, whose wheel radius turns a rim's speed into the wheel's.
    """
    units = dict(SCALES.get(UNITS[name], {}))
    if name in WHEELS:
        radius = drive.wheel_radius[WHEELS.index(name) % 2]
        units |= {unit: scale / radius for unit, scale in SCALES["m/s"].items()}
    elif UNITS[name] == "rad/s":
        del units["steps/s"]
    if name in ENCODERS:
        units |= TURNS
    if name == "t":
        units[ISO] = 1.0
    return units


def numbers(values: pd.Series[Any], field: str, expected: str = "numbers") -> pd.Series[float]:
    """A column as numbers, empty cells as NaN.

    Raises:
        InputError: the first cell that is no number.
    """
    with parsing(field, expected):
        found = pd.to_numeric(values, errors="coerce").astype(float)
    if len(wrong := values[found.isna() & values.notna()]):
        raise InputError(field, wrong.iloc[0], expected)
    return found


def iso_seconds(values: pd.Series[Any], field: str) -> pd.Series[float]:
    """s since 1970 of dates by ISO 8601, empty cells as NaN.

    Raises:
        InputError: the first cell that is no such date.
    """
    expected = "dates by ISO 8601, as 2024-05-01T12:00:00.25"
    with parsing(field, expected):
        texts = values.astype("string")
        found = pd.to_datetime(texts, format="ISO8601", utc=True, errors="coerce")
        since = (found - pd.Timestamp(0, tz="UTC")) / pd.Timedelta(1, "s")
    if len(wrong := values[found.isna() & values.notna()]):
        raise InputError(field, wrong.iloc[0], expected)
    return since.astype(float)


def heading(quaternion: FloatArray, field: str) -> FloatArray:
    """(rows,) yaw (rad) of the x axis of a body, seen from above.

    Args:
        quaternion: (rows, 4) x, y, z, w of any length, NaN where there is none.
        field: What to call it in a refusal.

    Raises:
        InputError: one is no rotation: all zero.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        size = np.linalg.norm(quaternion, axis=1)
    if (size == 0.0).any():
        raise InputError(field, "a quaternion of zeros", "rotations; empty where there is none")
    with np.errstate(invalid="ignore"):
        x, y, z, w = (quaternion / size[:, None]).T
    yaw: FloatArray = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return yaw

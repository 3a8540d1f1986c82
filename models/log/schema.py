"""The measured log's columns: names, units, and what a value may be.

One row per tracked moment of one robot: when, where the tracker saw it, what it was told to do,
and, where the lab has them, what its sensors read. SI units, REP-103 axes.
"""

from __future__ import annotations

import difflib

import pandas as pd

from realitygap.embedded_sim import SENSORS, InputError
from realitygap.embedded_sim.errors import LONGEST_NAME, nearest, shown
from realitygap.models.log.opened import parsing

POSE = ("x", "y", "yaw")
WHEEL_COMMANDS = ("cmd_left", "cmd_right")
BODY_COMMANDS = ("cmd_v", "cmd_omega")
ENCODERS = ("wheel_left", "wheel_right")
PS = tuple(f"ps{k}" for k in range(SENSORS))
LS = tuple(f"ls{k}" for k in range(SENSORS))
VIRTUAL = ("food", "nest")
ODOMETRY = ("odom_x", "odom_y", "odom_yaw")
CARRIED = ("gyro_z", *ODOMETRY)
"""What the robot measured of its own motion: kept with a log; nothing is concluded from it yet."""
KEYS = ("run", "robot")

UNITS = {
    "run": "",
    "robot": "",
    "t": "s",
    **dict(zip(POSE, ("m", "m", "rad"), strict=True)),
    **dict.fromkeys(WHEEL_COMMANDS, "rad/s"),
    **dict(zip(BODY_COMMANDS, ("m/s", "rad/s"), strict=True)),
    **dict.fromkeys(ENCODERS, "rad/s"),
    "gyro_z": "rad/s",
    **dict(zip(ODOMETRY, ("m", "m", "rad"), strict=True)),
    **dict.fromkeys((*PS, *LS), "counts"),
    **dict.fromkeys(VIRTUAL, "bool"),
    "case": "",
}
"""Every column and its unit."""

CASES = {"light-opposite-nest": 0, "no-light": 1, "light-at-nest": 2}
"""Light scenario of a row, as an index into `embedded_sim.SCENARIOS`."""
SWITCHING = ("at-nest-to-opposite", "opposite-to-at-nest")
"""Cases whose lamp moves at a time the log does not hold: their light cannot be predicted."""

_ROBOTS = 2**53
"""Largest number of a robot: whole numbers beyond are not exact in a column with holes."""
_NEAR = 0.75
"""Likeness above which an unknown column is taken for a misspelt one."""


def check_columns(columns: list[str]) -> list[str]:
    """Refuse a log without the needed columns; return the unknown columns, which are not read.

    Raises:
        InputError: a needed column is missing, only half of a pair is there, a column occurs twice,
            or an unknown column looks like a misspelt one.
    """
    twice = sorted({name for name in columns if columns.count(name) > 1})
    # of two columns of one name the reader of CSV calls the second x.1
    twice += [name for name in UNITS if name in columns and f"{name}.1" in columns]
    if twice:
        raise InputError("columns", f"{twice[0]} twice", "every column once")
    unknown = [name for name in columns if name not in UNITS]
    for name in ("robot", "t", *POSE):
        if name not in columns and not (name == "yaw" and not _instead(name, unknown)):
            expected = f"a column {name} ({UNITS[name] or 'whole number'}){_instead(name, unknown)}"
            expected += "; other names and units are for `realitygap import csv`"
            raise InputError("columns", ", ".join(map(str, columns)) or "none", expected)
    for name in unknown:
        # a lab's gyro_x is no misspelt gyro_z
        absent = [known for known in UNITS if known not in (*columns, *CARRIED)]
        word = shown(name, LONGEST_NAME).lower()
        if difflib.get_close_matches(word, absent, n=1, cutoff=_NEAR):
            raise InputError(f"column {name}", "an unknown name", nearest(word, absent))
    pairs = [pair for pair in (WHEEL_COMMANDS, BODY_COMMANDS) if set(pair) & set(columns)]
    if not pairs:
        raise InputError(
            "columns", "no commands", "cmd_left and cmd_right (rad/s), or cmd_v and cmd_omega"
        )
    if len(pairs) == 2:
        raise InputError("columns", "wheel and body commands", "one pair of commands, not both")
    for names in (*pairs, *([ENCODERS] if set(ENCODERS) & set(columns) else [])):
        for name in names:
            if name not in columns:
                raise InputError("columns", f"only half of {' and '.join(names)}", f"also {name}")
    return [str(name) for name in unknown]


def coerce(frame: pd.DataFrame) -> pd.DataFrame:
    """The known columns with their types.

    Raises:
        InputError: a value cannot be read as its column's type or is out of any range.
    """
    known = frame[[name for name in UNITS if name in frame.columns]]
    if len(known) and known["robot"].isna().any():
        raise InputError(
            "robot", f"{known['robot'].isna().sum()} empty values", "a robot in each row"
        )
    with parsing("column robot", "whole numbers"):
        robots = pd.to_numeric(known["robot"], errors="coerce").astype(float)
        wrong = known["robot"][(robots % 1 != 0) | (robots.abs() > _ROBOTS)]  # also for NaN
    if len(wrong):
        raise InputError("column robot", wrong.iloc[0], f"whole numbers within {_ROBOTS:g}")
    from realitygap.models.log.values import checked  # pandera takes a tenth of a second

    with parsing("log", "a table of numbers"):
        return checked(known)


def _instead(name: str, unknown: list[str]) -> str:
    """A hint at the unknown column that was probably meant."""
    lowered = {shown(other, LONGEST_NAME).lower(): str(other) for other in unknown}
    aliases = {"yaw": ("theta", "heading", "th", "psi"), "t": ("time", "stamp", "timestamp")}
    close = [n for n in aliases.get(name, ()) if n in lowered]
    close = close or difflib.get_close_matches(name, lowered, n=1, cutoff=0.6)
    return f"; is it {lowered[close[0]]}?" if close else ""

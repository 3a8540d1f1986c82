"""What a column's header says: which column of the measured log it may be, and in which unit."""

from __future__ import annotations

import re
from typing import NamedTuple

from realitygap.models.log.schema import (
    BODY_COMMANDS,
    CARRIED,
    ENCODERS,
    LS,
    PS,
    UNITS,
    VIRTUAL,
    WHEEL_COMMANDS,
)

UNIT_WORDS: dict[str, str] = {
    **{"s": "s", "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "msec": "ms", "us": "us"},
    **{"usec": "us", "ns": "ns", "nsec": "ns", "nanoseconds": "ns", "milliseconds": "ms"},
    **{"m": "m", "metres": "m", "meters": "m", "cm": "cm", "mm": "mm", "millimetres": "mm"},
    **{"rad": "rad", "radians": "rad", "deg": "deg", "degrees": "deg", "°": "deg"},
    **{"m/s": "m/s", "mps": "m/s", "cm/s": "cm/s", "mm/s": "mm/s", "mmps": "mm/s"},
    **{"rad/s": "rad/s", "rads": "rad/s", "radps": "rad/s", "deg/s": "deg/s", "degps": "deg/s"},
    **{"rpm": "rpm", "steps/s": "steps/s", "ticks": "ticks", "turns": "turns"},
}
"""Units as headers write them."""
_BRACKETS = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]\s*$")
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")

WHERE = frozenset(
    [
        "pose",
        "position",
        "pos",
        "field",
        "header",
        "msg",
        "data",
        "gt",
        "ground",
        "truth",
        "mocap",
        "vicon",
        "optitrack",
        "tracker",
        "true",
        "base",
        "link",
        "world",
        "map",
        "frame",
        "transform",
        "translation",
        "coordinate",
        "coord",
        "local",
        "global",
        "of",
        "robot",
        "observation",
        "state",
        "s",
        "p",
        "tb",
        "tb3",
    ]
)
"""Words that say where a number comes from, not what it is."""
TOLD = frozenset(
    [
        "cmd",
        "command",
        "commanded",
        "commands",
        "set",
        "setpoint",
        "target",
        "desired",
        "ref",
        "reference",
        "goal",
        "told",
        "action",
        "input",
        "control",
    ]
)
"""Words of what a robot was told."""
MOTION = frozenset(["vel", "twist"])
"""Words that only say that something moves."""
TURNED = frozenset(["enc", "encoder", "encoders", "wheel", "wheels", "measured", "actual", "joint"])
"""Words of what a wheel did."""
SIDES = {"left": "left", "l": "left", "right": "right", "r": "right"}
MOTOR = frozenset(
    ["v", "w", "speed", "velocity", "vel", "omega", "motor", "wheel", "rate", "rim", "u"]
)
"""Words that a side's speed may come with."""

PLAIN: dict[str, str] = {
    **dict.fromkeys(("t", "time", "stamp", "timestamp", "time stamp", "clock"), "t"),
    **dict.fromkeys(("datetime", "date", "elapsed", "elapsed time", "sim time"), "t"),
    **dict.fromkeys(("x", "px", "tx"), "x"),
    **dict.fromkeys(("y", "py", "ty"), "y"),
    **dict.fromkeys(("yaw", "theta", "heading", "psi", "th", "orientation", "angle"), "yaw"),
    **dict.fromkeys(("rotation", "azimuth", "orientation yaw", "rot"), "yaw"),
    **dict.fromkeys(("run", "trial", "episode", "episode index", "experiment", "session"), "run"),
    **dict.fromkeys(("run id", "trial id", "episode id", "run index"), "run"),
    **dict.fromkeys(("robot", "robot id", "id", "name", "robot name", "agent"), "robot"),
    **dict.fromkeys(("agent id", "vehicle", "namespace", "robot index", "uid"), "robot"),
}
"""Headers without where they come from, and the column that they are."""
BODY: dict[str, str] = {
    **dict.fromkeys(("v", "vx", "linear x", "linear", "speed", "velocity", "forward"), "cmd_v"),
    **dict.fromkeys(("lin", "linear velocity", "v lin", "vlin", "linear speed"), "cmd_v"),
    **dict.fromkeys(("omega", "w", "wz", "angular z", "angular", "turn", "yaw rate"), "cmd_omega"),
    **dict.fromkeys(("ang", "angular velocity", "v ang", "vang", "turn rate"), "cmd_omega"),
}
"""The same of a body's speeds, without words of what it was told."""
AXES = {"x": "cmd_v", "theta": "cmd_omega", "yaw": "cmd_omega", "z": "cmd_omega"}
"""The same of axes, which are places unless something was told."""
OWN = frozenset((*PS, *LS, *VIRTUAL, *CARRIED, "case"))
"""Columns that are known by the log's own names alone."""


class Header(NamedTuple):
    """What a header may mean."""

    column: str
    """Of the measured log; `qx`, `qy`, `qz`, `qw` of a quaternion; empty: nothing."""
    unit: str
    """As the header says; empty: it does not."""
    told: bool
    """It says that this was commanded."""
    exact: bool
    """It is the log's own name."""


def understood(header: str) -> Header:
    """What one header may mean."""
    words, unit = words_of(header)
    text = "_".join(words)
    if text in UNITS:
        return Header(text, unit, text in (*WHEEL_COMMANDS, *BODY_COMMANDS), True)
    if text in OWN:
        return Header(text, unit, False, True)
    told = bool(TOLD & set(words))
    for column in (_quaternion(words), PLAIN.get(" ".join(words)), _side(words, told)):
        if column:
            return Header(column, unit, told, False)
    bare = [word for word in words if word not in WHERE]
    if bare and not told and (column := PLAIN.get(" ".join(bare))):
        return Header(column, unit, False, False)
    rest = " ".join(word for word in bare if word not in TOLD | MOTION)
    if told and rest in AXES:
        return Header(AXES[rest], unit, told, False)
    return Header(BODY.get(rest, ""), unit, told, False)


def words_of(header: str) -> tuple[list[str], str]:
    """A header's words in small letters, and its unit."""
    unit = ""
    if match := _BRACKETS.search(header):
        unit, header = UNIT_WORDS.get(match[1].lower(), ""), header[: match.start()]
    words = re.findall(r"[a-z]+\d*|\d+|°", _CAMEL.sub(" ", header).lower())
    if not unit and len(words) > 1 and words[-1] in UNIT_WORDS:
        unit = UNIT_WORDS[words.pop()]
    return words, unit


def _quaternion(words: list[str]) -> str:
    """`qx` to `qw` of a part of a quaternion."""
    last = words[-1] if words else ""
    if last in ("qx", "qy", "qz", "qw"):
        return last
    if last in ("x", "y", "z", "w") and {"orientation", "quaternion", "quat", "rotation", "q"} & {
        *words
    }:
        return f"q{last}"
    return ""


def _side(words: list[str], told: bool) -> str:
    """A speed of one wheel; without words of what was told or measured, told."""
    split = [part for word in words for part in ([word[0], word[1]] if _is_short(word) else [word])]
    sides = {SIDES[word] for word in split if word in SIDES}
    others = {word for word in split if word not in SIDES} - WHERE
    if len(sides) != 1 or not others <= MOTOR | TOLD | TURNED | {"ticks"}:
        return ""
    side = sides.pop()
    turned = bool(others & (TURNED | {"ticks"})) and not told
    pair = ENCODERS if turned else WHEEL_COMMANDS
    return pair[0] if side == "left" else pair[1]


def _is_short(word: str) -> bool:
    """Such as vl, wr."""
    return len(word) == 2 and word[0] in "vwu" and word[1] in SIDES

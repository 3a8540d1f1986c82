"""A map for a table that has none: columns by their headers, units by headers, values and motion.

What a header does not say is tried: of all usual units and signs those are taken under which the
measured motion follows the commands. The map is written as TOML, for its user to correct.
"""

from __future__ import annotations

import itertools
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import tomli_w

from realitygap.embedded_sim import Drive, InputError
from realitygap.embedded_sim.errors import LONGEST_NAME, shown
from realitygap.models.log.agreement import STEPS, Driven, UnitReading, disagreement
from realitygap.models.log.course import courses
from realitygap.models.log.files import checked
from realitygap.models.log.formats.headers import Header, understood
from realitygap.models.log.formats.mapped import Map, by_map
from realitygap.models.log.formats.streams import merged
from realitygap.models.log.formats.units import ISO, SCALES, TURNS, iso_seconds, units_of
from realitygap.models.log.measured import wheel_commands
from realitygap.models.log.named import numbered
from realitygap.models.log.plausible import GOOD
from realitygap.models.log.schema import BODY_COMMANDS, ENCODERS, POSE, UNITS, WHEEL_COMMANDS

ROWS = 4000
"""Rows of which motion is tried. Our choice: minutes of a robot."""
WRONG = 0.67
"""Disagreement from which on units are wrong: a fifth of the motion told, (1 - 0.2) / (1 + 0.2).
Robots on ice turn by a third of it; the nearest two units, rpm and rad/s, are 9.5 apart."""
LATEST = 1e10
"""s since 1970: the year 2286."""
FEASIBLE = 3.0
"""Times the fastest a wheel turns that it is told at most: in logarithms half way to a unit ten
times as large."""
TICKS = '# Encoders may be named, as wheel_left = { from = "...", unit = "ticks", per_turn = ... }.'
QUATERNION = ("qx", "qy", "qz", "qw")
_NUMBER = re.compile(r"-?[0-9.]+(e[+-]?[0-9]+)?", re.IGNORECASE)
Told = dict[str, str | float]
"""Unit and scale of a column, where they are not the log's own."""


def guess(
    raw: pd.DataFrame,
    path: Path,
    *,
    drive: Drive,
    fastest: float | None = None,
    seen: pd.DataFrame | None = None,
) -> str:
    """The text of a map for a table, with what each line was guessed by.

    Args:
        raw: The table.
        path: Its file, for messages.
        drive: The nominal geometry.
        fastest: rad/s, most a wheel of this robot turns, if known: no reading goes far beyond.
        seen: Poses of the robot, where they come from another file.

    Raises:
        InputError: no time, no pose or no commands were recognised; says which.
    """
    found = _columns(raw, path, poses=seen is None)
    units = {name: header.unit for name, (_, header) in found.items() if header.unit}
    given: dict[str, Told] = {name: {"unit": unit} for name, unit in units.items()}
    given["t"] = _time(raw[found["t"][0]], path, units.get("t"))
    why = dict.fromkeys(found, "by its header")
    why["t"] = "by its header" if "t" in units else "its unit by its values"
    readings = list(_readings(found, units))
    off = [_off(raw, found, {**given, **one}, path, drive, fastest, seen) for one in readings]
    best = _best(readings, off)
    by = "by how the robot moved" if off[best] <= GOOD else "the log's own, as motion does not tell"
    for name, told in readings[best].items():
        why[name] = by if name not in units or "scale" in told else why[name]
    return _text(raw, found, {**given, **readings[best]}, why, path, off[best])


def _columns(raw: pd.DataFrame, path: Path, *, poses: bool) -> dict[str, tuple[str, Header]]:
    """By column of the log the header it is taken from, and what that says."""
    found: dict[str, tuple[str, Header]] = {}
    for header in map(str, raw.columns):
        said = understood(header)
        name = said.column
        if not name or (said.unit and name in UNITS and said.unit not in units_of(name, Drive())):
            continue
        if name in ENCODERS and not said.exact and (said.unit in TURNS or not said.unit):
            continue  # an angle or a speed: only its owner knows, and a turn's ticks as well
        former = found.get(name)
        better = former is None or (said.exact, said.told) > (former[1].exact, former[1].told)
        if better:
            found[name] = (header, said)
    if not poses:
        found = {n: one for n, one in found.items() if n not in (*POSE, *QUATERNION)}
    whole = all(name in found for name in QUATERNION)
    if "yaw" in found or not whole:
        found = {name: one for name, one in found.items() if name not in QUATERNION}
    _one_pair(found)
    needed = ("t", "x", "y") if poses else ("t",)
    if len(raw.columns) and all(_NUMBER.fullmatch(str(header)) for header in raw.columns):
        raise InputError(path.name, "numbers in the first line", "the names of the columns there")
    missing = [name for name in needed if name not in found]
    if not any(set(pair) <= set(found) for pair in (WHEEL_COMMANDS, BODY_COMMANDS)):
        missing.append("commands")
    if missing:
        listed = ", ".join(shown(name, LONGEST_NAME) for name in raw.columns)
        name = "cmd_v" if missing[0] == "commands" else missing[0]
        lines = f'a map (--map): [columns], then lines as {name} = "HEADER"'
        expected = f"columns that say which they are, or {lines}"
        said_missing = f"no column that looks like {', '.join(missing)} among {listed}"
        raise InputError(path.name, said_missing, expected)
    return found


def _one_pair(found: dict[str, tuple[str, Header]]) -> None:
    """Keep one whole pair of commands, the one whose headers say so, and whole pairs of wheels."""
    pairs = [pair for pair in (WHEEL_COMMANDS, BODY_COMMANDS) if set(pair) <= set(found)]
    chosen = max(pairs, key=lambda pair: found[pair[0]][1].told, default=())
    for name in (*WHEEL_COMMANDS, *BODY_COMMANDS):
        if name not in chosen:
            found.pop(name, None)
    if not set(ENCODERS) <= set(found):
        for name in ENCODERS:
            found.pop(name, None)


def _time(values: pd.Series[float], path: Path, unit: str | None) -> Told:
    """The unit of a time."""
    if unit is not None:
        return {"unit": unit}
    if not pd.api.types.is_numeric_dtype(values.dtype):
        iso_seconds(values, f"{path.name}: {values.name}")
        return {"unit": ISO}
    largest, step = float(values.abs().max()), values.diff()
    usual = float(step[step > 0].median())
    for name, scale in SCALES["s"].items():
        if STEPS[0] <= usual * scale <= STEPS[1] and largest * scale <= LATEST:
            return {"unit": name}
    return {"unit": "s"}


def _readings(
    found: Mapping[str, tuple[str, Header]], units: Mapping[str, str]
) -> Iterator[dict[str, Told]]:
    """Every usual way to read what headers leave open, the log's own units first."""
    lengths: list[dict[str, Told]] = [{}]
    if "x" in found and not {"x", "y"} & set(units):
        lengths = [{name: {"unit": unit} for name in ("x", "y")} for unit in SCALES["m"]]
    angles: list[dict[str, Told]] = [{}]
    if "yaw" in found:
        known = [units["yaw"]] if "yaw" in units else list(SCALES["rad"])
        angles = [
            {"yaw": {"unit": unit, "scale": sign}}
            for sign, unit in itertools.product((1, -1), known)
        ]
    told = [name for name in (*WHEEL_COMMANDS, *BODY_COMMANDS) if name in found]
    open_ = [name for name in told if name not in units]
    commands: list[dict[str, Told]] = [{}]
    if open_ == list(WHEEL_COMMANDS):
        kinds = units_of("cmd_left", Drive())
        commands = [{name: {"unit": unit} for name in open_} for unit in kinds]
    elif open_:
        kinds_of = [list(units_of(name, Drive())) for name in open_]
        commands = [
            {n: {"unit": u} for n, u in zip(open_, chosen, strict=True)}
            for chosen in itertools.product(*kinds_of)
        ]
    for length, angle, command in itertools.product(lengths, angles, commands):
        yield {**length, **angle, **command}


def _best(readings: list[dict[str, Told]], off: list[float]) -> int:
    """The reading to take: the first, in the log's own units, unless its units are wrong.

    Of the others the one with the fewest changes: lengths, angles and speeds that are all wrong by
    like factors agree as well as they do in their own units.
    """
    if off[0] < WRONG:
        return 0
    for most in (GOOD, WRONG):
        fit = [k for k, one in enumerate(off) if one < most]
        if fit:
            return min(fit, key=lambda k: (_changes(readings[k]), off[k]))
    return 0


def _changes(reading: Mapping[str, Told]) -> int:
    """How many units and signs of a reading are not the log's own."""
    parts = [(name, reading[name]) for name in reading if name not in ("y", "cmd_right")]
    units = sum(told.get("unit", UNITS[name]) != UNITS[name] for name, told in parts)
    return units + sum(told.get("scale", 1) != 1 for _, told in parts)


def _off(
    raw: pd.DataFrame,
    found: Mapping[str, tuple[str, Header]],
    given: Mapping[str, Told],
    path: Path,
    drive: Drive,
    fastest: float | None,
    seen: pd.DataFrame | None,
) -> float:
    """How little motion follows the commands under a reading, 0 to 1; 1 where nothing is told."""
    table = by_map(
        raw.head(ROWS),
        _read(_lines(found, given)),
        path=path,
        folder=path.parent,
        name=path.name,
        drive=drive,
    )
    if seen is not None:
        table = merged([table, seen], path.name)
    robots, _ = numbered(table["robot"])
    run = table["run"].astype(str) if "run" in table else "run"
    table = table.assign(robot=robots, run=run).dropna(subset=["t"])
    table = table.sort_values(["run", "robot", "t"], kind="stable")
    commands = wheel_commands(table, drive)
    whole = np.isfinite(commands).all(axis=1)
    table, commands = (
        table[pd.Series(whole, index=table.index)],
        np.ascontiguousarray(commands[whole]),
    )
    if len(table) < 2:
        return 1.0
    told = float(np.quantile(np.abs(commands), 0.9))
    if fastest is not None and told > FEASIBLE * fastest:
        return 1.0
    new = (table[["run", "robot"]] != table[["run", "robot"]].shift()).any(axis=1).to_numpy()
    start = np.append(np.flatnonzero(new), len(table)).astype(np.int64)
    t = table["t"].to_numpy(dtype=float)
    if "yaw" not in table:
        places = table[["x", "y"]].to_numpy(dtype=float)
        table = table.assign(yaw=courses(t, places, commands, np.cumsum(new))[0])
    poses = table[list(POSE)].to_numpy(dtype=float)
    if (np.diff(t)[~new[1:]] <= 0).any():
        return 1.0  # the log's own reader says what is wrong with its time
    rows = Driven(t, np.ascontiguousarray(poses), commands, start, drive)
    off = disagreement(rows, UnitReading())
    return 1.0 if off is None else off


def _lines(
    found: Mapping[str, tuple[str, Header]],
    given: Mapping[str, Told],
    why: Mapping[str, str] | None = None,
) -> str:
    """`[columns]` as TOML."""
    lines = []
    for name in [one for one in UNITS if one in found or (one == "yaw" and "qw" in found)]:
        if name not in found:
            parts = ", ".join(_quoted(found[one][0]) for one in QUATERNION)
            lines.append(f"yaw = {{ quaternion = [{parts}] }}")
            continue
        unit, scale = given.get(name, {}).get("unit"), given.get(name, {}).get("scale", 1)
        content = _quoted(found[name][0])
        if unit is not None or scale != 1:
            content = f"{{ from = {content}"
            content += "" if unit is None else f', unit = "{unit}"'
            content += ("" if scale == 1 else f", scale = {scale}") + " }"
        said = "" if why is None else f"  # {why[name]}"
        lines.append(f"{name} = {content}{said}")
    return "\n".join(["[columns]", *lines, ""])


def _text(
    raw: pd.DataFrame,
    found: Mapping[str, tuple[str, Header]],
    given: Mapping[str, Told],
    why: Mapping[str, str],
    path: Path,
    agrees: float,
) -> str:
    """The map as a file, with what is to be known of it."""
    used = {header for header, _ in found.values()}
    left = [shown(name, LONGEST_NAME) for name in raw.columns if str(name) not in used]
    head = [f"# Guessed from {shown(path.name)}. Correct it, and give it with --map."]
    if agrees > GOOD:
        head.append("# The measured motion follows the commands in no usual units: look twice.")
    if left:
        head.append(f"# Not used: {', '.join(left)}.")
    if any("tick" in name.lower() or "encoder" in name.lower() for name in left):
        head.append(TICKS)
    return "\n".join([*head, "", _lines(found, given, why)])


def _quoted(text: str) -> str:
    """A TOML string."""
    return tomli_w.dumps({"a": text}).removeprefix("a = ").rstrip("\n")


def _read(text: str) -> Map:
    """The map in a text."""
    return checked(Map, tomllib.loads(text), Path("map.toml"), "a map")

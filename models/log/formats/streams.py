"""What a robot logged by several clocks or at several rates, as one table.

Commands and poses make the rows (`log.formats.joined`). Everything else is brought to these
times: angles and speeds of wheels and gyroscopes as the mean since the row before, odometry by
interpolation, and what a sensor said holds until it says something else.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.formats.joined import BRIDGE, interpolated, join, latest, series
from realitygap.models.log.formats.units import ANGLES
from realitygap.models.log.schema import (
    BODY_COMMANDS,
    ENCODERS,
    KEYS,
    ODOMETRY,
    POSE,
    WHEEL_COMMANDS,
)

RATES = (*ENCODERS, "gyro_z")
"""Columns that are means since the row before."""


def merged(streams: Sequence[pd.DataFrame], field: str) -> pd.DataFrame:
    """One table out of several with `t` (s), each by its own clock ticks but of one time.

    A stream with `robot` or `run` is divided by them; one without belongs to every robot.

    Args:
        streams: Columns as in the measured log, or wheel angles (`units.ANGLES`).
        field: What to call them in a refusal.

    Raises:
        InputError: commands or poses are missing, or no robot has both.
    """
    pair = next((p for p in (WHEEL_COMMANDS, BODY_COMMANDS) if _with(streams, p)), None)
    if pair is None:
        raise InputError(field, "no pair of commands", "cmd_left, cmd_right or cmd_v, cmd_omega")
    headless = not any("yaw" in one for one in streams)
    if not _with(streams, POSE[:2] if headless else POSE):
        raise InputError(field, "no pose", "x, y and yaw, or x and y alone")
    parts = []
    for keys, own in _robots(streams):
        table = _of_robot(own, pair)
        if table is not None:
            parts.append(table.assign(**keys))
    if not parts:
        raise InputError(field, "no robot with both commands and poses", "rows of each")
    return pd.concat(parts, ignore_index=True)


def with_speeds(table: pd.DataFrame) -> pd.DataFrame:
    """A table of one clock with wheel angles turned into speeds, rows as they are."""
    wheels = [name for name in ENCODERS if ANGLES[name] in table]
    if not wheels:
        return table
    keys = [name for name in KEYS if name in table]
    groups = table.groupby(keys, sort=False, dropna=False) if keys else [((), table)]
    parts = []
    for _, part in groups:
        t = part["t"].to_numpy(dtype=float)
        speeds = {name: _rate(t, part[ANGLES[name]].to_numpy(dtype=float)) for name in wheels}
        parts.append(part.assign(**speeds))
    angles = [ANGLES[name] for name in wheels]
    return pd.concat(parts).sort_index().drop(columns=angles) if parts else table


def _with(streams: Sequence[pd.DataFrame], names: Sequence[str]) -> bool:
    return any(set(names) <= set(one) for one in streams)


def _robots(streams: Sequence[pd.DataFrame]) -> Iterator[tuple[dict[str, Any], list[pd.DataFrame]]]:
    """The streams of each robot in each run, and who it is."""
    keyed = [one[[k for k in KEYS if k in one]].drop_duplicates() for one in streams]
    named = [one.dropna() for one in keyed if len(one.columns)]
    if not named:
        yield {}, list(streams)
        return
    widest = max(named, key=lambda one: len(one.columns))
    for row in widest.to_dict("records"):
        keys = {str(name): value for name, value in row.items()}
        yield keys, [_only(one, keys) for one in streams]


def _only(stream: pd.DataFrame, keys: dict[str, Any]) -> pd.DataFrame:
    for name, value in keys.items():
        if name in stream:
            stream = stream[stream[name] == value]
    return stream


def _of_robot(streams: Sequence[pd.DataFrame], pair: tuple[str, ...]) -> pd.DataFrame | None:
    """One robot's rows; None: it was never told or never seen."""
    told_in = next(one for one in streams if set(pair) <= set(one))
    pose = [name for name in POSE if any(name in one for one in streams)]
    seen_in = next(one for one in streams if set(pose) <= set(one))
    told, seen = latest(*series(told_in, "t", list(pair))), latest(*series(seen_in, "t", pose))
    if len(told[0]) < 2 or len(seen[0]) < 2:
        return None
    t, held, at = join(told[0], told[1], seen[0], seen[1])
    columns: dict[str, Any] = {"t": t, **dict(zip(pose, at.T, strict=True))}
    columns |= dict(zip(pair, held.T, strict=True))
    for one in streams:
        angles = {angle: name for name, angle in ANGLES.items()}
        for name in one:
            wanted = angles.get(str(name), str(name))
            if wanted not in columns and wanted not in KEYS:
                columns[wanted] = _sampled(one, str(name), t)
    return pd.DataFrame(columns)


def _sampled(stream: pd.DataFrame, name: str, t: FloatArray) -> Any:
    """(rows,) a column at other times; empty where its neighbours are too far away."""
    rows = stream[["t", name]].dropna().sort_values("t", kind="stable")
    when, values = latest(rows["t"].to_numpy(dtype=float), rows[name].to_numpy())
    if len(when) < 2:
        return np.full(len(t), np.nan)
    if name in RATES:
        grown = np.cumsum(values.astype(float)[1:] * np.diff(when))
        return _rate(t, _between(when, np.concatenate([[0.0], grown]), t))
    if name in ANGLES.values():
        return _rate(t, _between(when, values.astype(float), t))
    if name in ODOMETRY:
        if name == ODOMETRY[2]:
            values = np.unwrap(values.astype(float))
        return _between(when, values.astype(float), t)
    at = np.searchsorted(when, t, side="right") - 1
    old = t - when[at] > BRIDGE * np.median(np.diff(when))
    return pd.Series(values[np.maximum(at, 0)]).mask((at < 0) | old).to_numpy()


def _between(when: FloatArray, values: FloatArray, t: FloatArray) -> FloatArray:
    """(rows,) values at other times by interpolation; NaN outside, and in gaps."""
    found = interpolated(when, values[:, None], t)[:, 0]
    found[(t < when[0]) | (t > when[-1])] = np.nan
    return found


def _rate(t: FloatArray, angle: FloatArray) -> FloatArray:
    """(rows,) mean change per second since the row before; NaN of the first."""
    rate = np.full(len(t), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate[1:] = np.diff(angle) / np.diff(t)
    rate[~np.isfinite(rate)] = np.nan
    return rate

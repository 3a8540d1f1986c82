"""What labs do to a log between robots and file, each a pure function of a log.

A change takes a log as `realitygap run` writes it and a generator, and gives a new log. None knows
what was hidden, nor the model. Columns that do not say when or where (commands, wheels, sensors)
keep the value of the last row before, unless a change says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from realitygap.embedded_sim.model import FloatArray
from realitygap.reality import constants as k

Change: TypeAlias = Callable[[pd.DataFrame, np.random.Generator], pd.DataFrame]
POSE = ["x", "y", "yaw"]
TRACK = ["run", "robot"]
OUTLIER = (0.1, 0.1, 1.0)
"""m, m, rad: standard deviations of a pose that belongs to no robot; our choice."""
MOST_JITTER = 3.0
"""Standard deviations of a stamp's jitter, at most, so that time goes on increasing."""


def unchanged(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
    """The log as it is."""
    return log


def every_nth(n: int) -> Change:
    """Of every robot the first row of `n`; what was commanded in between is lost."""
    return lambda log, random: _rows(log, _row(log) % n == 0)


def resampled(rate: float) -> Change:
    """Rows at another rate (Hz); poses are interpolated between their neighbours."""

    def anew(track: pd.DataFrame) -> pd.DataFrame:
        first, last = track["t"].iloc[0], track["t"].iloc[-1]
        rows = math.floor((last - first) * rate + 1e-6) + 1
        return _at(track, first + np.arange(rows) / rate)

    return lambda log, random: _by_track(log, anew)


def pose_every(n: int) -> Change:
    """A pose in the first row of `n` only."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        there = (_row(log) % n == 0).to_numpy()[:, None]
        return _posed(log, np.where(there, log[POSE].to_numpy(), np.nan))

    return change


def held(n: int) -> Change:
    """A tracker slower than the log: the first pose of `n` rows is repeated in the others."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        group = _row(log) // n
        first = log.groupby([*TRACK, group], observed=True)[POSE].transform("first")
        return log.assign(**{name: first[name] for name in POSE})

    return change


def averaged(n: int) -> Change:
    """Every pose the mean of `n`, itself in the middle; fewer at a track's ends."""
    return lambda log, random: _filtered(
        log, lambda poses: poses.rolling(n, center=True, min_periods=1).mean()
    )


def lowpassed(seconds: float) -> Change:
    """A causal first-order filter of poses with this time constant (s)."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        share = 1.0 - math.exp(-_step(log) / seconds)
        return _filtered(log, lambda poses: poses.ewm(alpha=share, adjust=False).mean())

    return change


def noisier(times: float) -> Change:
    """The tracker's white noise is this many times what it was."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        added = math.sqrt(times**2 - 1.0)
        scale = added * np.array([k.TRACKER_NOISE, k.TRACKER_NOISE, k.TRACKER_YAW_NOISE])
        return _posed(log, log[POSE].to_numpy() + scale * random.standard_normal((len(log), 3)))

    return change


def outliers(share: float) -> Change:
    """This share of poses lies anywhere near the right one."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        wild = random.random(len(log)) < share
        thrown = np.array(OUTLIER) * random.standard_normal((len(log), 3))
        return _posed(log, log[POSE].to_numpy() + wild[:, None] * thrown)

    return change


def quantised(length: float, angle: float) -> Change:
    """Positions in whole steps of `length` (m), headings of `angle` (rad)."""
    step = np.array([length, length, angle])
    return lambda log, random: _posed(log, np.rint(log[POSE].to_numpy() / step) * step)


def jittered(seconds: float) -> Change:
    """Stamps are off by this standard deviation (s)."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        z = np.clip(random.standard_normal(len(log)), -MOST_JITTER, MOST_JITTER)
        return log.assign(t=log["t"] + seconds * z)

    return change


def merged(direction: str) -> Change:
    """Poses are measured between commands, and each gets the `backward` or `nearest` command.

    A tracker's rows begin anywhere in the robots' step. What the robots log comes with commands.
    """

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        step = _step(log)
        late = step * random.uniform(0.05, 0.95)
        ahead = step if direction == "nearest" and late > 0.5 * step else 0.0

        def anew(track: pd.DataFrame) -> pd.DataFrame:
            kept = track["t"].iloc[:-1] + late
            poses = _at(track, kept.to_numpy())
            given = _at(track, kept.to_numpy() - late + ahead)
            return given.assign(t=poses["t"], **{name: poses[name] for name in POSE})

        return _by_track(log, anew)

    return change


def tracker_fast(rate: float) -> Change:
    """The tracker's clock is faster than the robots' by this share; both began together.

    A pose that bears a time of the robots is older, and ever more so.
    """

    def drifted(track: pd.DataFrame) -> pd.DataFrame:
        first = track["t"].iloc[0]
        seen = _at(track, (first + (track["t"] - first) / (1.0 + rate)).to_numpy())
        return track.assign(**{name: seen[name].to_numpy() for name in POSE})

    return lambda log, random: _by_track(log, drifted)


def framed(
    angle: float = 0.0, scale: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)
) -> Change:
    """Another frame: turned by `angle` (rad) about the origin, then scaled, then shifted (m)."""

    def change(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        x, y, yaw = log[POSE].to_numpy().T
        c, s = math.cos(angle), math.sin(angle)
        turned = scale * np.stack([c * x - s * y, s * x + c * y]) + np.array(shift)[:, None]
        yaw = yaw if angle == 0.0 else _wrapped(yaw + angle)
        return _posed(log, np.column_stack([*turned, yaw]))

    return change


def first(seconds: float) -> Change:
    """The first seconds alone."""
    return lambda log, random: _rows(log, log["t"] < log["t"].min() + seconds - 1e-9)


def without(*beginnings: str) -> Change:
    """Columns that begin with one of these are not logged."""
    return lambda log, random: log.drop(
        columns=[name for name in log.columns if name.startswith(beginnings)]
    )


def without_odd_robots(log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
    """Robots with odd numbers drive among the others, and are not logged."""
    return _rows(log, log["robot"] % 2 == 0)


def _rows(log: pd.DataFrame, kept: pd.Series) -> pd.DataFrame:
    return log.loc[kept]


def _tracks(log: pd.DataFrame) -> Any:
    return log.groupby(TRACK, sort=False, observed=True)


def _row(log: pd.DataFrame) -> pd.Series:
    """Of every row its number within its track."""
    row: pd.Series = _tracks(log).cumcount()
    return row


def _step(log: pd.DataFrame) -> float:
    """s between the rows of a track, most often."""
    return float(_tracks(log)["t"].diff().median())


def _by_track(log: pd.DataFrame, change: Callable[[pd.DataFrame], pd.DataFrame]) -> pd.DataFrame:
    """Every track changed by itself."""
    return pd.concat([change(track) for _, track in _tracks(log)], ignore_index=True)


def _posed(log: pd.DataFrame, poses: FloatArray) -> pd.DataFrame:
    return log.assign(**dict(zip(POSE, poses.T, strict=True)))


def _filtered(log: pd.DataFrame, smooth: Callable[[pd.DataFrame], pd.DataFrame]) -> pd.DataFrame:
    """Poses of every track smoothed, headings as they go on turning."""

    def change(track: pd.DataFrame) -> pd.DataFrame:
        poses = smooth(track[POSE].assign(yaw=np.unwrap(track["yaw"])))
        return track.assign(x=poses["x"], y=poses["y"], yaw=_wrapped(poses["yaw"].to_numpy()))

    return _by_track(log, change)


def _at(track: pd.DataFrame, t: FloatArray) -> pd.DataFrame:
    """A track at other times (s): poses interpolated, all else from the last row before."""
    measured = track["t"].to_numpy()
    before = np.searchsorted(measured, t + 1e-9, side="right") - 1
    yaw = _wrapped(np.interp(t, measured, np.unwrap(track["yaw"])))
    x, y = (np.interp(t, measured, track[name]) for name in ("x", "y"))
    return track.iloc[before].reset_index(drop=True).assign(t=t, x=x, y=y, yaw=yaw)


def _wrapped(angle: FloatArray) -> FloatArray:
    """In [-pi, pi)."""
    return np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi

"""What labs do to a log between robots and file, each a pure function of a log.

A change takes a log as `realitygap run` writes it and a generator, and gives a new log. None knows
what was hidden, nor the model. Columns that do not say when or where (commands, wheels, sensors)
keep the value of the last row before, unless a change says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
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


@dataclass(frozen=True)
class EveryNth:
    """Of every robot the first row of `n`; what was commanded in between is lost."""

    n: int

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        return _rows(log, _row(log) % self.n == 0)


@dataclass(frozen=True)
class Resampled:
    """Rows at another rate (Hz); poses are interpolated between their neighbours."""

    rate: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        def anew(track: pd.DataFrame) -> pd.DataFrame:
            first, last = track["t"].iloc[0], track["t"].iloc[-1]
            rows = math.floor((last - first) * self.rate + 1e-6) + 1
            return _at(track, first + np.arange(rows) / self.rate)

        return _by_track(log, anew)


@dataclass(frozen=True)
class PoseEvery:
    """A pose in the first row of `n` only."""

    n: int

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        there = (_row(log) % self.n == 0).to_numpy()[:, None]
        return _posed(log, np.where(there, log[POSE].to_numpy(), np.nan))


@dataclass(frozen=True)
class Held:
    """A tracker slower than the log: the first pose of `n` rows is repeated in the others."""

    n: int

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        group = _row(log) // self.n
        held = log.groupby([*TRACK, group], observed=True)[POSE].transform("first")
        return log.assign(**{name: held[name] for name in POSE})


@dataclass(frozen=True)
class Averaged:
    """Every pose the mean of `n`, itself in the middle; fewer at a track's ends."""

    n: int

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        return _filtered(
            log, lambda poses: poses.rolling(self.n, center=True, min_periods=1).mean()
        )


@dataclass(frozen=True)
class Lowpassed:
    """A causal first-order filter of poses with this time constant (s)."""

    seconds: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        share = 1.0 - math.exp(-_step(log) / self.seconds)
        return _filtered(log, lambda poses: poses.ewm(alpha=share, adjust=False).mean())


@dataclass(frozen=True)
class Noisier:
    """The tracker's white noise is this many times what it was."""

    times: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        added = math.sqrt(self.times**2 - 1.0)
        scale = added * np.array([k.TRACKER_NOISE, k.TRACKER_NOISE, k.TRACKER_YAW_NOISE])
        return _posed(log, log[POSE].to_numpy() + scale * random.standard_normal((len(log), 3)))


@dataclass(frozen=True)
class Outliers:
    """This share of poses lies anywhere near the right one."""

    share: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        wild = random.random(len(log)) < self.share
        thrown = np.array(OUTLIER) * random.standard_normal((len(log), 3))
        return _posed(log, log[POSE].to_numpy() + wild[:, None] * thrown)


@dataclass(frozen=True)
class Quantised:
    """Positions in whole steps of `length` (m), headings of `angle` (rad)."""

    length: float
    angle: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        step = np.array([self.length, self.length, self.angle])
        return _posed(log, np.rint(log[POSE].to_numpy() / step) * step)


@dataclass(frozen=True)
class Jittered:
    """Stamps are off by this standard deviation (s)."""

    seconds: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        z = np.clip(random.standard_normal(len(log)), -MOST_JITTER, MOST_JITTER)
        return log.assign(t=log["t"] + self.seconds * z)


@dataclass(frozen=True)
class Merged:
    """Poses are measured between commands, and each gets the `backward` or `nearest` command.

    A tracker's rows begin anywhere in the robots' step. What the robots log comes with commands.
    """

    direction: str

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        step = _step(log)
        late = step * random.uniform(0.05, 0.95)
        ahead = step if self.direction == "nearest" and late > 0.5 * step else 0.0

        def merged(track: pd.DataFrame) -> pd.DataFrame:
            kept = track["t"].iloc[:-1] + late
            poses = _at(track, kept.to_numpy())
            given = _at(track, kept.to_numpy() - late + ahead)
            return given.assign(t=poses["t"], **{name: poses[name] for name in POSE})

        return _by_track(log, merged)


@dataclass(frozen=True)
class TrackerFast:
    """The tracker's clock is faster than the robots' by this share; both began together.

    A pose that bears a time of the robots is older, and ever more so.
    """

    rate: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        def drifted(track: pd.DataFrame) -> pd.DataFrame:
            first = track["t"].iloc[0]
            seen = _at(track, (first + (track["t"] - first) / (1.0 + self.rate)).to_numpy())
            return track.assign(**{name: seen[name].to_numpy() for name in POSE})

        return _by_track(log, drifted)


@dataclass(frozen=True)
class Framed:
    """Another frame: turned by `angle` (rad) about the origin, then scaled, then shifted (m)."""

    angle: float = 0.0
    scale: float = 1.0
    shift: tuple[float, float] = (0.0, 0.0)

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        x, y, yaw = log[POSE].to_numpy().T
        c, s = math.cos(self.angle), math.sin(self.angle)
        turned = (
            self.scale * np.stack([c * x - s * y, s * x + c * y]) + np.array(self.shift)[:, None]
        )
        yaw = yaw if self.angle == 0.0 else _wrapped(yaw + self.angle)
        return _posed(log, np.column_stack([*turned, yaw]))


@dataclass(frozen=True)
class First:
    """The first seconds alone."""

    seconds: float

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        return _rows(log, log["t"] < log["t"].min() + self.seconds - 1e-9)


@dataclass(frozen=True)
class Without:
    """Columns that begin with one of these are not logged."""

    beginnings: tuple[str, ...]

    def __call__(self, log: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
        return log.drop(columns=[name for name in log.columns if name.startswith(self.beginnings)])


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

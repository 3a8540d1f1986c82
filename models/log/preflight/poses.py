"""What a tracker's poses are like: their steps, failures, and whether the yaw is the motion's."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import wrapped
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise

SINGLE = 2.0**-22
"""Relative to the largest value, a step that numbers of single precision have by themselves: they
hold 24 bits, and sums of them two less."""
ON_STEP = 0.1
"""Of a step, off a whole number of which a difference may be and count as on it; by chance a fifth
of all differences are."""
STEPPED = 0.99
"""Share of differences on it that makes a step. Our choice."""
LAGS = (1, 2, 4, 8, 16)
"""Poses apart, of which the first is taken that is far enough: 16 poses are 0.6 s at 25 Hz."""
FAR = 20.0
"""Times the noise of a position that a robot must usually move for its direction to be seen: then
it is seen within 4 degrees."""
BETTER = 0.5
"""Disagreement of a mistaken reading with the motion, of the yaw's own, below which it fits better:
as for mistakes of units."""
BESIDE = np.pi / 4.0
"""rad between yaw and motion from which on they disagree. Our choice: an eighth of a turn."""


class Failures(NamedTuple):
    """Shares of a log's poses."""

    outliers: float
    """That were set aside as failures of the tracker."""
    beyond: float | None
    """Further out than the wall lets a robot's middle be, by more than noise; None: no wall."""
    furthest: float
    """m from the middle, the furthest pose that was not set aside."""


class Facing(NamedTuple):
    """The yaw beside the direction in which robots move."""

    apart: float
    """Share of the moves that are not within an eighth of a turn of the yaw."""
    offset: float
    """rad, mean direction of motion less yaw."""
    like: str
    """What the yaw looks like: `yaw`, or a usual mistake that fits the motion better."""


def step_of(values: FloatArray) -> float | None:
    """The step in which values come; None: there is none beyond that of single precision.

    Args:
        values: (n,), NaN where unknown.
    """
    levels = np.unique(values[np.isfinite(values)])
    apart = np.diff(levels)
    # one decimal that was reached by two ways is two doubles
    apart = apart[apart > SINGLE * np.abs(levels).max(initial=0.0)]
    if not len(apart):
        return None
    step = float(apart.min())
    whole = np.round(apart / step)
    step = float(apart @ whole / (whole @ whole))
    off = np.abs(apart / step - np.round(apart / step))
    return step if np.mean(off < ON_STEP) > STEPPED else None


def steps_of(log: MeasuredLog) -> tuple[float | None, float | None]:
    """m and rad: steps of position and yaw; None: there is none."""
    x, y, yaw = (step_of(column) for column in log.poses.T)
    return (None if x is None or y is None else max(x, y)), yaw


def failures(log: MeasuredLog, noise: PoseNoise, reach: float | None) -> Failures:
    """Poses that cannot be.

    Args:
        log: Measured.
        noise: Of its tracker.
        reach: m from the middle that the wall lets a robot's middle be; None: no wall.
    """
    seen = np.isfinite(log.poses).all(axis=1)
    far = np.hypot(*log.poses[log.tracked, :2].T)
    beyond = None
    if reach is not None:
        beyond = float(np.mean(far > reach + 3.0 * noise.position)) if len(far) else 0.0
    wild = float((seen & ~log.tracked).sum() / max(int(seen.sum()), 1))
    return Failures(wild, beyond, float(far.max(initial=0.0)))


def facing(log: MeasuredLog, noise: PoseNoise, drive: Drive) -> Facing | None:
    """Whether robots move the way they are said to look; None: they hardly move, or nowhere.

    Args:
        log: Measured.
        noise: Of its tracker.
        drive: Tells whether a command is ahead or back.
    """
    ahead = np.sign(log.commands @ np.array(drive.wheel_radius))
    known = np.flatnonzero(log.tracked)
    for lag in LAGS:
        first, last = known[:-lag], known[lag:]
        way = ahead[first]
        steady = (log.stretch[first] == log.stretch[last]) & (way == ahead[last]) & (way != 0.0)
        first, last, way = first[steady], last[steady], way[steady]
        moved = (log.poses[last, :2] - log.poses[first, :2]) * way[:, None]
        far = np.hypot(*moved.T)
        if len(far) and np.median(far) > FAR * noise.position:
            break
    else:
        return None
    clear = far > FAR * noise.position
    direction = np.arctan2(moved[clear, 1], moved[clear, 0])
    begin, end = log.poses[first[clear], 2], log.poses[last[clear], 2]
    off = {name: direction - _between(a, b) for name, (a, b) in _readings(begin, end).items()}
    mean = {name: np.mean(np.exp(1j * apart)) for name, apart in off.items()}
    lack = {name: 1.0 - float(np.abs(one)) for name, one in mean.items()}
    nearest = min(lack, key=lack.__getitem__)
    return Facing(
        apart=float(np.mean(np.abs(wrapped(off["yaw"])) > BESIDE)),
        offset=float(np.angle(mean["yaw"])),
        like=nearest if lack[nearest] < BETTER * lack["yaw"] else "yaw",
    )


def _readings(begin: FloatArray, end: FloatArray) -> dict[str, tuple[FloatArray, FloatArray]]:
    """By what a yaw may be instead, the angles (rad) at both ends of the moves."""
    found = {
        "yaw": (begin, end),
        "clockwise": (-begin, -end),
        "degrees": (np.radians(begin), np.radians(end)),
    }
    if max(np.abs(begin).max(), np.abs(end).max()) <= 1.0:
        found["quaternion z"] = (2.0 * np.arcsin(begin), 2.0 * np.arcsin(end))
    return found


def _between(begin: FloatArray, end: FloatArray) -> FloatArray:
    """(n,) rad halfway the short way round: an arc's chord lies along it."""
    return np.asarray(begin + 0.5 * wrapped(end - begin))

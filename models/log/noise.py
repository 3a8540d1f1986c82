"""The tracker's noise, estimated from the log itself, and what it alone does to a window's error.

Noise is what changes from one row to the next while the model's error does not: the second
difference of the one-step errors cancels any error that is steady over three rows, and has six
times the variance of white noise. Medians keep gross failures out; rows just after a change of
command, where a real motor is still catching up, are left out as long as enough others remain.
Coloured noise (a tracker that smooths) looks smaller than it is.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Windows, motion, moved, wrapped
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.tracker import NORMAL

SPAN = 0.04
"""s between the poses that are compared, or a row where rows are rarer: what is white from one
pose to the next is wanted, and a log that was interpolated to a higher rate says less than its
rows. Our choice: trackers of 25 Hz and more are the usual ones."""
SETTLED = 0.2
"""s a command must have held to count as steady. Our choice: several time constants of a small
robot's motor (47-107 ms from step to full speed on real ones)."""
ENOUGH = 200
"""Steady rows that suffice for an estimate within about 7 %."""
LEAST = (1e-9, 1e-9)
"""m, rad: noise is never taken to be below this; rounding is."""


class PoseNoise(NamedTuple):
    """Standard deviations of the tracker's white noise."""

    position: float
    """m, along each axis."""
    heading: float
    """rad."""


def pose_noise(log: MeasuredLog, replayed: FloatArray) -> PoseNoise:
    """The tracker's noise; `replayed` (rows, 3) is the log's commands through the model."""
    known = np.flatnonzero(log.tracked)
    apart = _rows_of(SPAN, log.t[known])
    first, rows, last = known[: -2 * apart], known[apart:-apart], known[2 * apart :]
    before, after = Windows(first, rows), Windows(rows, last)
    whole = log.stretch[first] == log.stretch[last]
    if len(rows):  # a tracker may be slower than the log; a lost pose is not bridged
        whole &= last - first <= 2.0 * apart * np.median(np.diff(known))
    settled = whole & steady(log)[rows]
    use = settled if settled.sum() >= min(ENOUGH, 0.5 * whole.sum()) else whole
    if not use.any():
        return PoseNoise(*LEAST)
    poses = log.poses
    change = _world_error(poses, replayed, after) - _world_error(poses, replayed, before)
    change = change[use]
    change[:, 2] = wrapped(change[:, 2])
    spread = NORMAL * np.median(np.abs(change), axis=0) / np.sqrt(6.0)
    position = float(np.hypot(spread[0], spread[1]) / np.sqrt(2.0))
    return PoseNoise(max(position, LEAST[0]), max(float(spread[2]), LEAST[1]))


def window_noise(poses: FloatArray, pairs: Windows, noise: PoseNoise) -> FloatArray:
    """(windows, 3) standard deviation of a window's error under tracker noise alone.

    Both ends are measured: their position noise adds, and the start's heading noise swings the
    whole predicted path about the start.
    """
    path = motion(poses, pairs)
    swing = np.abs(path[:, [1, 0]]) * noise.heading
    both = np.hypot(np.sqrt(2.0) * noise.position, swing)
    heading = np.full((len(path), 1), np.sqrt(2.0) * noise.heading)
    return np.hstack([both, heading])


def steady(log: MeasuredLog) -> npt.NDArray[np.bool_]:
    """(rows,) whether the command has been the same for `SETTLED` s."""
    settled = _rows_of(SETTLED, log.t)
    same = np.zeros(len(log.t), dtype=bool)
    same[1:] = (np.diff(log.commands, axis=0) == 0).all(axis=1)
    same[1:] &= np.diff(log.segment) == 0
    held = np.cumsum(same)
    result = np.zeros(len(same), dtype=bool)
    result[settled:] = held[settled:] - held[:-settled] == settled
    return result


def _world_error(poses: FloatArray, replayed: FloatArray, pairs: Windows) -> FloatArray:
    """(windows, 3) measured minus predicted motion over each step, in the world's axes."""
    return poses[pairs.last] - moved(poses[pairs.first], motion(replayed, pairs))


def _rows_of(seconds: float, t: FloatArray) -> int:
    """Rows nearest to a time, at least one; `t` (rows,) s."""
    step = float(np.median(np.diff(t))) if len(t) > 1 else seconds
    return max(1, round(seconds / step)) if step > 0.0 else 1

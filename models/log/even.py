"""Stamps that jitter about even times, beside motion that does not.

A tracker takes poses evenly, and a network stamps them early and late. The motion tells whether a
row's stamp is when its pose was taken: a robot under a held command goes as far as time went on.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray

RESOLVED = 1e-9
"""s: a jitter below it is none. Stamps of robots are whole nanoseconds at best."""
LEAST = 100
"""Moves from which one is told."""
FOLLOWED = 0.1
"""Of a stamp's deviation, by which the even time after it is moved."""
ROUNDS = 3
"""Times that stamps are counted by a line through all of them."""
HALF = 0.5
"""Share of the stamps' jitter that the motion must surely not have."""
SURE = 3.0
"""Standard errors that make it sure."""


def evened(
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    start: npt.NDArray[np.int64],
    drive: Drive,
) -> FloatArray | None:
    """(rows,) s, even times about which the stamps jitter; None: stamps are to be believed.

    Args:
        t: (rows,) s.
        poses: (rows, 3) measured, NaN where lost.
        commands: (rows, 2) rad/s.
        start: (segments + 1,) first rows, and the row count.
        drive: The nominal motion model.
    """
    even = np.empty_like(t)
    for begin, end in pairwise(start.tolist()):
        own = _even(t[begin:end])
        if own is None:
            return None
        even[begin:end] = own
    if np.std(t - even) < RESOLVED:
        return None
    moves = np.flatnonzero((np.diff(commands, axis=0) == 0.0).all(axis=1))  # to the row after
    moves = moves[~np.isin(moves + 1, start)]
    rim = commands[moves] * np.array(drive.wheel_radius)
    speed = rim.mean(axis=1)
    turned = 0.5 * (rim[:, 1] - rim[:, 0]) / drive.axle * (even[moves + 1] - even[moves])
    way = poses[moves, 2] + turned
    went = poses[moves + 1, :2] - poses[moves, :2]
    ahead = went[:, 0] * np.cos(way) + went[:, 1] * np.sin(way)
    both = np.column_stack([even[moves + 1] - even[moves], np.zeros(len(moves))])
    both[:, 1] = t[moves + 1] - t[moves] - both[:, 0]
    both *= speed[:, None]
    told = np.isfinite(ahead) & (speed != 0.0)
    if told.sum() < LEAST:
        return None
    share, error = _share(both[told], ahead[told])
    return even if share + SURE * error < HALF else None


def _even(t: FloatArray) -> FloatArray | None:
    """(rows,) the even times nearest to some stamps; None: there are no such."""
    if len(t) < 3:
        return t
    step = float(np.median(np.diff(t)))
    if np.std(np.diff(t)) < RESOLVED:
        return t
    counted = np.maximum(np.round(np.diff(t) / step), 1.0)
    tick = _ticks(t, float((t[-1] - t[0]) / counted.sum()))
    for _ in range(ROUNDS):
        step, begin = np.polyfit(tick, t, 1)
        tick = np.round((t - begin) / step)
    even = begin + step * tick
    return np.asarray(even) if np.abs(t - even).max() < 0.5 * step else None


def _ticks(t: FloatArray, step: float) -> FloatArray:
    """(rows,) steps since the first stamp, each counted from where those before place the last."""
    ticks, at = [0.0], float(t[0])
    for stamp in t[1:].tolist():
        took = max(round((stamp - at) / step), 1)
        ticks.append(ticks[-1] + took)
        at += took * step
        at += FOLLOWED * (stamp - at)
    return np.array(ticks)


def _share(columns: FloatArray, ahead: FloatArray) -> tuple[float, float]:
    """How much of the second of two columns (n, 2) lies in (n,), and its standard error."""
    inverse = np.linalg.pinv(columns.T @ columns)
    found = inverse @ (columns.T @ ahead)
    left = ahead - columns @ found
    error = np.sqrt(left @ left / len(left) * inverse[1, 1])
    return float(found[1]), float(error)

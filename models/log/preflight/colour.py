"""Whether a tracker's noise hangs together from one pose to the next: averaged, filtered or
interpolated poses show it.

Where a command holds, measured less predicted poses drift smoothly, and noise is what is left of
them beside a parabola in time. Fitting it away changes the covariances of what is left in a known
way, which is undone: of white noise the correlation found is zero in the mean.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows, Windows, motion, moved, wrapped
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import steady

POSES = 12
"""Poses of a window. Our choice: 0.44 s at 25 Hz; foraging robots' commands hold as long now and
then, and a command's motion is a smooth curve."""
SMOOTH = 3
"""Coefficients of a parabola: errors of speed and turn rate bend so short a path no more."""
REACH = 3
"""Poses over which noise may hang together. Our choice: averages over up to four are told exactly,
over more a little low; with five, 50 windows would not tell white noise from an average."""
ODD = 10.0
"""Times the usual sum of squares beyond which a window is left out. Our choice: of normal noise
with 9 degrees of freedom none is."""
PARTS = 10
"""Parts of the windows, each of which is left out once for the interval. Our choice."""
NOMINAL = 2.26
"""Standard deviations on each side of 95 %, by Student's t with `PARTS` - 1 degrees of freedom."""


class Correlation(NamedTuple):
    """Of a tracker's noise with itself one pose later."""

    value: float
    """0: white; 2/3: averages over three poses, or every second pose interpolated."""
    low: float
    high: float
    """95 %."""


def colour(log: MeasuredLog, replayed: FloatArray) -> tuple[Correlation | None, Correlation | None]:
    """Of position and heading; None: commands never hold for long enough.

    Args:
        log: Measured.
        replayed: (rows, 3) its commands through the model.
    """
    rows = _windows(log)
    if len(rows) < PARTS:
        return None, None
    pairs = Windows(rows[:, :-1].ravel(), rows[:, 1:].ravel())
    error = log.poses[pairs.last] - moved(log.poses[pairs.first], motion(replayed, pairs))
    error[:, 2] = wrapped(error[:, 2])
    path = np.zeros((len(rows), POSES, 3))
    path[:, 1:] = np.cumsum(error.reshape(len(rows), POSES - 1, 3), axis=1)
    left = np.einsum("ij,wjk->kwi", _without_smooth(), path)
    return _correlation(np.vstack(left[:2])), _correlation(left[2])


def may_be_filtered(log: MeasuredLog, replayed: FloatArray) -> bool:
    """Whether a position's noise surely hangs together, as that of filtered poses does; arguments
    as `colour`."""
    position, _ = colour(log, replayed)
    return position is not None and position.low > 0.0


def _windows(log: MeasuredLog) -> Rows:
    """(windows, POSES) rows of successive, evenly spaced poses under one command."""
    known = np.flatnonzero(log.tracked)
    if len(known) < POSES:
        return np.zeros((0, POSES), dtype=np.int64)
    each = np.diff(known)
    usual = int(np.median(each))
    held = steady(log)
    good = (each == usual) & (np.diff(log.stretch[known]) == 0) & held[known[1:]]
    good &= held[known[:-1]]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]])))
    found = [
        known[k : k + POSES]
        for begin, end in zip(edges[::2], edges[1::2], strict=True)
        for k in range(begin, end + 2 - POSES, POSES)
    ]
    return np.array(found, dtype=np.int64).reshape(-1, POSES)


def _without_smooth() -> FloatArray:
    """(POSES, POSES) takes a parabola in time off a window."""
    basis, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, POSES), SMOOTH))
    return np.asarray(np.eye(POSES) - basis @ basis.T)


def _mixing() -> FloatArray:
    """(REACH + 1, REACH + 1) by lag, what is left of covariances once the parabola is off."""
    off = _without_smooth()
    lag = np.abs(np.subtract.outer(np.arange(POSES), np.arange(POSES)))
    found = np.empty((REACH + 1, REACH + 1))
    for k in range(REACH + 1):
        left = off @ (lag == k) @ off
        found[:, k] = [float(np.trace(left, j)) for j in range(REACH + 1)]
    return found


def _correlation(left: FloatArray) -> Correlation | None:
    """Of (windows, POSES) what is left; None: nothing is."""
    square = (left**2).sum(axis=1)
    left = left[square <= ODD * np.median(square)]
    if not left.any():
        return None
    products = np.column_stack(
        [(left[:, : POSES - j] * left[:, j:]).sum(axis=1) for j in range(REACH + 1)]
    )
    mixing = _mixing()

    def of(sums: FloatArray) -> float:
        own, next_one = np.linalg.solve(mixing, sums)[:2]
        return float(next_one / own)

    value = of(products.sum(axis=0))
    part = np.arange(len(left)) * PARTS // len(left)
    without = [of(products[part != k].sum(axis=0)) for k in range(PARTS)]
    half = NOMINAL * float(np.sqrt((PARTS - 1) * np.var(without)))
    return Correlation(value, value - half, value + half)

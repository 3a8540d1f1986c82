"""Means of errors over blocks of time: their intervals, and whether one prediction beats another.

Neighbouring errors are alike: a block, not a window, is what counts as one observation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import stdtr

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows

BLOCK_SECONDS = 5.0
"""s held out, resampled or compared together: longer than most contacts and any tracker's filter.
Our choice."""
RESAMPLED = 400
"""Bootstrap samples of blocks for an interval."""


ROUNDED = 1e-6
"""Of a length, by which a time may lie before a boundary and count as on it: times of any origin
are rounded. No rule: far below a row, far above rounding."""


class Better(NamedTuple):
    """How much smaller one prediction's mean error is than another's."""

    share: float
    """Of the other's mean error; negative: it is larger."""
    level: float
    """One-sided level at which it is smaller, by Student's t over blocks; near 1: larger."""


def nth(seconds: FloatArray, long: FloatArray | float) -> Rows:
    """(n,) which of successive equal lengths of time each moment lies in.

    Args:
        seconds: (n,) s since the first begins.
        long: s, of one.
    """
    return np.asarray(np.floor(seconds / long + ROUNDED), dtype=np.int64)


def better(before: FloatArray, after: FloatArray, block: Rows) -> Better | None:
    """Compare two predictions of the same windows.

    Args:
        before: (n,) size of the errors of the one.
        after: (n,) of the other.
        block: (n,) block of each.

    Returns:
        None where there are fewer than two blocks, which say nothing of chance, or where the two
        are the same.
    """
    known = np.isfinite(before) & np.isfinite(after)
    before, after, block = before[known], after[known], block[known]
    each = np.unique(block, return_inverse=True)[1]
    number = np.bincount(each)
    if len(number) < 2:
        return None
    won = before - after
    if not won.any():
        return None
    mean = float(won.mean())
    left = np.bincount(each, won) - mean * number
    blocks = len(number)
    error = float(np.sqrt(np.sum(left**2) * blocks / (blocks - 1)) / number.sum())
    # where every block gains as much, chance has no part in it
    level = float(mean < 0.0) if error == 0.0 else float(stdtr(blocks - 1, -mean / error))
    return Better(mean / max(float(before.mean()), np.finfo(float).tiny), level)


def interval(size: FloatArray, block: Rows, rng: np.random.Generator) -> tuple[float, float]:
    """95 % interval of a mean, by resampling blocks."""
    known = np.isfinite(size)
    each = np.unique(block[known], return_inverse=True)[1]
    number, total = np.bincount(each), np.bincount(each, size[known])
    picks = rng.integers(0, len(number), (RESAMPLED, len(number)))
    tried = total[picks].sum(axis=1) / number[picks].sum(axis=1)
    low, high = np.quantile(tried, (0.025, 0.975))
    return float(low), float(high)

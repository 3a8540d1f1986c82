"""Are errors larger than noise makes them, whatever they depend on?

The sign-flip maps (`gap.flips`) find errors whose mean depends on something. Late commands, slow
motors and contacts also make errors that average out and are still far larger than noise: their
spread, relative to the noise of each window, says so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import stats

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.shares import INNER

GROUPS = 20
"""Parts of the log left out in turn (jackknife)."""
LEAST_GROUPS = 6
"""Fewer say too little of their own scatter to be judged by."""
NOISE_ERROR = 0.05
"""Relative s.d. of the noise estimated from the log itself. Our choice: it errs by less than 10 %
where the noise is known."""


class Excess(NamedTuple):
    """One channel's spread against noise."""

    ratio: float
    """Robust spread of the errors, each in units of its own noise: 1 where noise is all."""
    p: float
    """Chance of a ratio so large from noise alone; family-wise."""


def excess(
    error: FloatArray, noise: FloatArray, block: npt.NDArray[np.int64], *, family: int = 1
) -> Excess:
    """Test whether a channel's errors spread more than its noise.

    Args:
        error: (n,) measured minus predicted; NaN is left out.
        noise: (n,) standard deviation of noise alone, > 0.
        block: (n,) stretch of time of each error: errors of one block may hang together.
        family: How many such tests are judged together (Bonferroni).
    """
    known = np.isfinite(error)
    size = error[known] / noise[known]
    part = np.unique(block[known], return_inverse=True)[1] % GROUPS
    groups = int(part.max()) + 1 if len(part) else 0
    if groups < LEAST_GROUPS:
        return Excess(_spread(size) if len(size) else 0.0, 1.0)
    whole = _spread(size)
    without = np.array([_spread(size[part != g]) for g in range(groups)])
    if min(whole, without.min()) <= 0.0:
        return Excess(whole, 1.0)
    logs = np.log(without)
    variance = (groups - 1) / groups * float(((logs - logs.mean()) ** 2).sum())
    t = np.log(whole) / np.sqrt(variance + NOISE_ERROR**2)
    return Excess(whole, float(min(1.0, family * stats.t.sf(t, groups - 1))))


def _spread(values: FloatArray) -> float:
    """Robust standard deviation: a third of the range between normal -1.5 and 1.5 s.d."""
    low, high = np.quantile(values, INNER)
    return float(high - low) / 3.0

"""How much of a channel's error is noise, bias, or structured.

Robust throughout: bias is the mean of clipped errors, spread a third of the range of its inner 87
%, so that one to four per cent of gross failures hardly count. A spread within two standard errors
of what noise alone gives is noise. The mean square error they make up is split into what tracker or
sensor noise alone would give, what a constant offset gives, and the rest, which depends on
something: where, how fast, when.

Late commands, slow motors and contacts also make errors that average out, whatever they depend on,
and are still far larger than noise: their spread, relative to the noise of each window, says so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import stats

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.flips import CLIP, Means

INNER = (0.0668, 0.9332)
"""Quantiles of a normal variable at -1.5 and 1.5 standard deviations."""
EFFICIENCY = 0.65
"""Of that range as a measure of spread of normal errors, against their standard deviation."""


class Share(NamedTuple):
    """One channel's error, split; shares sum to 1 unless there is no error at all."""

    rms: float
    """Robust root mean square error, in the channel's unit."""
    bias_value: float
    """Mean error, gross failures clipped, in the channel's unit."""
    noise_rms: float
    """Root mean square that noise alone gives, in the channel's unit."""
    noise: float
    bias: float
    structured: float


def split(error: FloatArray, noise: FloatArray) -> Share:
    """Split a channel's error.

    Args:
        error: (n,) measured minus predicted; NaN is left out.
        noise: (n,) standard deviation expected of noise alone.
    """
    known = np.isfinite(error)
    error, noise = error[known], noise[known]
    if not len(error):
        return Share(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    floor = float(np.sqrt(np.mean(noise**2)))
    spread = float(np.diff(np.quantile(error, INNER))[0]) / 3.0
    reach = CLIP * max(spread, floor)
    bias = float(np.mean(np.clip(error - np.median(error), -reach, reach)) + np.median(error))
    uncertain = spread**2 / len(error)
    slack = 1.0 + 2.0 * np.sqrt(2.0 / (EFFICIENCY * len(error)))
    total = bias**2 + spread**2
    if total <= 0.0:
        return Share(0.0, bias, floor, 0.0, 0.0, 0.0)
    bias_share = max(0.0, bias**2 - uncertain) / total
    beyond = (float(np.diff(np.quantile((error - bias) / noise, INNER))[0]) / 3.0) ** 2
    noise_share = spread**2 / (1.0 if beyond < slack else beyond) / total
    structured = max(0.0, 1.0 - bias_share - noise_share)
    whole = bias_share + noise_share + structured
    return Share(
        float(np.sqrt(total)),
        bias,
        floor,
        noise_share / whole,
        bias_share / whole,
        structured / whole,
    )


def explained(found: Means, rms: float) -> float:
    """Share of the mean square error that differences between a map's groups account for.

    Less what chance gives; for the map of everything together, what its offset accounts for.
    """
    n = found.number.sum()
    if not n or rms <= 0.0:
        return 0.0
    weight = found.number / n
    centre = 0.0 if len(weight) == 1 else (weight * found.mean).sum()
    beyond = (weight * ((found.mean - centre) ** 2 - found.error**2)).sum()
    return float(np.clip(beyond / rms**2, 0.0, 1.0))


def telling(found: Means) -> int:
    """The group of a map that stands out most."""
    n = max(int(found.number.sum()), 1)
    several = int((found.number > 0).sum()) > 1
    centre = (found.number * found.mean).sum() / n if several else 0.0
    away = np.abs(found.mean - centre) / np.where(found.error > 0, found.error, np.inf)
    return int(away.argmax())


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

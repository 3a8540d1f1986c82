"""How much of a channel's error is noise, bias, or structured.

Robust throughout: bias is the mean of clipped errors, spread a third of the range of its inner 87
%, so that one to four per cent of gross failures hardly count. A spread within two standard errors
of what noise alone gives is noise. The mean square error they make up is split into what tracker or
sensor noise alone would give, what a constant offset gives, and the rest, which depends on
something: where, how fast, when.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

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

"""Bootstrap intervals and Wilcoxon's test of paired runs."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
from scipy import stats

Array = npt.NDArray[np.float64]
Statistic = Callable[[Sequence[Array]], float]

RESAMPLES = 2000
"""Bootstrap resamples; our choice: the ends of a 95 % interval rest on 50 each."""
FEWEST = 3
"""Runs below which an interval says nothing; our choice: of two, every resample is one of four."""
LEVEL = 0.95
"""Coverage of intervals."""


def mean(values: Sequence[Array]) -> float:
    """Mean of the first."""
    return float(values[0].mean())


def wilcoxon(differences: Array) -> float:
    """p of paired differences, or of values beyond a bound, being positive by chance."""
    if not _usable(differences):
        return float("nan")
    if not differences.any():
        return 1.0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # small samples with ties: the approximation is used
        return float(stats.wilcoxon(differences, alternative="greater").pvalue)


def interval(
    statistic: Statistic,
    samples: Sequence[Array],
    random: np.random.Generator,
    *,
    paired: bool = False,
) -> tuple[float, float, Array]:
    """Percentile interval of a statistic of resampled runs, and the resampled statistics.

    Args:
        statistic: Of the samples.
        samples: A value per run each.
        random: The claim's own stream.
        paired: The samples are of the same runs, resampled together.
    """
    drawn = np.empty(RESAMPLES)
    for at in range(RESAMPLES):
        if paired:
            chosen = random.integers(len(samples[0]), size=len(samples[0]))
            drawn[at] = statistic([sample[chosen] for sample in samples])
        else:
            drawn[at] = statistic([random.choice(sample, len(sample)) for sample in samples])
    if not np.isfinite(drawn).any():
        return float("nan"), float("nan"), drawn
    low, high = np.nanquantile(drawn, [(1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0])
    return float(low), float(high), drawn


def _usable(*samples: Array) -> bool:
    """Two runs at least, and no missing value."""
    return all(len(sample) >= 2 and np.isfinite(sample).all() for sample in samples)

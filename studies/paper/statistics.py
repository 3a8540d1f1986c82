"""How a claim is weighed: an effect with a bootstrap interval, and the probability of chance.

All tests are one-sided, and each claim has two: one for it and the same one against it. Every value
is one run, so runs are what is resampled.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

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
"""Coverage of intervals; its complement is the chance of any wrong verdict in a table of claims."""


@dataclass(frozen=True)
class ClaimEvidence:
    """What the numbers say of a claim."""

    effect: float
    low: float
    high: float
    p: float
    """Probability of so much support by chance; NaN where it cannot be computed."""
    p_against: float
    """Probability of so much contradiction by chance, by the same test turned round."""
    region: tuple[float, float]
    """Effects for which the claim holds."""
    runs: int
    """Values the test rests on."""

    @property
    def points(self) -> str:
        """Where the estimate lies: "with" the claim, "against" it, or empty without one."""
        if not np.isfinite(self.effect):
            return ""
        return "with" if self.region[0] < self.effect < self.region[1] else "against"


def ratio(values: Sequence[Array]) -> float:
    """Mean of the first over the mean of the second."""
    below = float(values[1].mean())
    return float(values[0].mean()) / below if below else float("nan")


def smallest_ratio(values: Sequence[Array], split: int) -> float:
    """Least ratio of a mean of the first `split` samples to a mean of the others."""
    above, below = values[:split], values[split:]
    return min(ratio((a, b)) for a in above for b in below)


def spread(values: Array) -> float:
    """Mean absolute deviation from the median: what Brown and Forsythe compare."""
    return float(np.abs(values - np.median(values)).mean())


def spread_ratio(values: Sequence[Array]) -> float:
    """Spread of the first over the spread of the second."""
    below = spread(values[1])
    return spread(values[0]) / below if below else float("nan")


def mean(values: Sequence[Array]) -> float:
    """Mean of the first."""
    return float(values[0].mean())


def mann_whitney(more: Array, less: Array) -> float:
    """p of `more` being larger than `less` by chance."""
    if not _usable(more, less):
        return float("nan")
    return float(stats.mannwhitneyu(more, less, alternative="greater").pvalue)


def wilcoxon(differences: Array) -> float:
    """p of paired differences, or of values beyond a bound, being positive by chance."""
    if not _usable(differences):
        return float("nan")
    if not differences.any():
        return 1.0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # small samples with ties: the approximation is used
        return float(stats.wilcoxon(differences, alternative="greater").pvalue)


def brown_forsythe(wide: Array, narrow: Array) -> float:
    """p of `wide` being more spread than `narrow` by chance, one-sided; two runs have no spread."""
    if not _usable(wide, narrow) or min(len(wide), len(narrow)) < 3:
        return float("nan")
    with np.errstate(divide="ignore", invalid="ignore"):  # NaN where nothing is spread
        two_sided = float(stats.levene(wide, narrow, center="median").pvalue)
    return two_sided / 2.0 if spread(wide) > spread(narrow) else 1.0 - two_sided / 2.0


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


def outside(drawn: Array, region: tuple[float, float]) -> float:
    """p of the effect lying outside a region: the share of resamples that do, never zero."""
    return _share(~_within(drawn, region))


def inside(drawn: Array, region: tuple[float, float]) -> float:
    """p of the effect lying inside a region: the share of resamples that do, never zero."""
    return _share(_within(drawn, region))


def largest(p_values: Sequence[float]) -> float:
    """p of a claim that needs every one of its comparisons."""
    return float(np.max(p_values))


def smallest(p_values: Sequence[float]) -> float:
    """p of a claim that one of its comparisons is enough for, corrected for their number."""
    return min(1.0, len(p_values) * float(np.min(p_values)))


def needed(claims: int) -> float:
    """p below which a claim is decided in either direction, by Bonferroni over the table.

    A claim is true or false, so only one of its two verdicts can be wrong: the number of claims,
    not of tests, is corrected for. Holm's steps would not hold, because a claim that is decided one
    way still has a true hypothesis the other way.
    """
    return (1.0 - LEVEL) / claims


def _within(drawn: Array, region: tuple[float, float]) -> npt.NDArray[np.bool_]:
    return (drawn > region[0]) & (drawn < region[1])


def _share(which: npt.NDArray[np.bool_]) -> float:
    return float((1 + np.count_nonzero(which)) / (1 + len(which)))


def _usable(*samples: Array) -> bool:
    """Two runs at least, and no missing value."""
    return all(len(sample) >= 2 and np.isfinite(sample).all() for sample in samples)

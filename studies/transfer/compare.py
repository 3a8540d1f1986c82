"""Paired comparison of the models: differences of runs with the same seed, with 95 % intervals.

Intervals are bootstrapped; the test is Wilcoxon's.
"""

from __future__ import annotations

import warnings
import zlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy import stats

from realitygap.studies.transfer.measures import METRICS

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


PAIRS = (("extended", "minimal"), ("oracle", "minimal"), ("oracle", "extended"))
"""First less second."""


def compare(table: pd.DataFrame, seed: int) -> pd.DataFrame:
    """Every metric of every pair in every alteration.

    Args:
        table: `measures.collect`.
        seed: Of the bootstrap over runs.

    Returns:
        alteration, metric, unit, first, second, mean_first, mean_second, difference, low, high,
        p (two-sided Wilcoxon), pairs, verdict (`more`, `less`, `not shown` by the interval; empty
        with too few pairs).
    """
    rows = []
    for alteration, part in table.groupby("alteration", sort=False):
        for metric, unit in METRICS.items():
            wide = part.pivot(index="index", columns="model", values=metric)
            for first, second in PAIRS:
                if first not in wide or second not in wide:
                    continue
                pair = wide[[first, second]].dropna().to_numpy(dtype=np.float64)
                found = {"alteration": alteration, "metric": metric, "unit": unit}
                rows.append(found | _pair(pair, first, second, seed, f"{alteration}.{metric}"))
    return pd.DataFrame(rows)


def _pair(pair: Any, first: str, second: str, seed: int, purpose: str) -> dict[str, Any]:
    """One comparison of (runs, 2) values."""
    found: dict[str, Any] = {"first": first, "second": second}
    nothing = float("nan")
    if not len(pair):
        means, difference = (nothing, nothing), nothing
    else:
        means = (float(pair[:, 0].mean()), float(pair[:, 1].mean()))
        difference = means[0] - means[1]
    low = high = p = nothing
    if len(pair) >= FEWEST:
        key = zlib.crc32(f"{purpose}.{first}.{second}".encode())
        random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key,)))
        low, high, _ = interval(mean, [pair[:, 0] - pair[:, 1]], random)
        p = min(1.0, 2.0 * min(wilcoxon(pair @ sign) for sign in ([1.0, -1.0], [-1.0, 1.0])))
    verdict = "" if np.isnan(low) else "more" if low > 0 else "less" if high < 0 else "not shown"
    return found | {
        "mean_first": means[0],
        "mean_second": means[1],
        "difference": difference,
        "low": low,
        "high": high,
        "p": p,
        "pairs": len(pair),
        "verdict": verdict,
    }

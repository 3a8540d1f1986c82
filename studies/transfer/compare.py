"""Paired comparison of the models: differences of runs with the same seed, with 95 % intervals."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
import pandas as pd

from realitygap.studies.paper.statistics import FEWEST, interval, mean, wilcoxon
from realitygap.studies.transfer.measures import METRICS

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

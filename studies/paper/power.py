"""What so many runs can decide: the power of the tests that verdicts rest on.

Simulated with runs that scatter normally. Tests are one-sided, and decide at the p that a table of
so many claims needs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from realitygap.studies.paper.statistics import Array, needed

POWER = 0.8
"""Share of studies that shall decide; the customary figure."""
STUDIES = 2000
"""Simulated for each size of effect; our choice: a standard error of 0.01 at a power of 0.8."""
HALVINGS = 12
"""Of the range of effects searched; our choice: 1/4096 of it."""

Draw = Callable[[np.random.Generator, int, float], Array]


@dataclass(frozen=True)
class OneSided:
    """One of the tests: p of simulated studies, and what its effect is."""

    name: str
    compares: str
    unit: str
    p: Draw
    """(studies,) p from a random stream, runs and the true effect."""
    null: float
    """Effect of no difference."""
    most: float
    """Largest effect tried."""


def _wilcoxon(random: np.random.Generator, runs: int, effect: float) -> Array:
    values = random.normal(effect, 1.0, (STUDIES, runs))
    return np.asarray(stats.wilcoxon(values, axis=1, alternative="greater").pvalue)


def _mann_whitney(random: np.random.Generator, runs: int, effect: float) -> Array:
    more, less = random.normal(effect, 1.0, (STUDIES, runs)), random.normal(size=(STUDIES, runs))
    return np.asarray(stats.mannwhitneyu(more, less, axis=1, alternative="greater").pvalue)


def _brown_forsythe(random: np.random.Generator, runs: int, effect: float) -> Array:
    wide, narrow = random.normal(0.0, effect, (STUDIES, runs)), random.normal(size=(STUDIES, runs))
    if runs < 3:
        return np.ones(STUDIES)  # two runs have no spread
    two_sided = np.asarray(stats.levene(wide, narrow, center="median", axis=1).pvalue)
    wider = wide.std(axis=1) > narrow.std(axis=1)
    return np.where(wider, two_sided / 2.0, 1.0)


TESTS = (
    OneSided(
        "Wilcoxon", "halves of the same runs, or runs with a bound", "s.d.", _wilcoxon, 0.0, 10.0
    ),
    OneSided("Mann–Whitney", "two conditions", "s.d.", _mann_whitney, 0.0, 10.0),
    OneSided("Brown–Forsythe", "two spreads", "times the spread", _brown_forsythe, 1.0, 100.0),
)


def detectable(test: OneSided, runs: int, claims: int) -> float:
    """The smallest effect that is decided in `POWER` of studies; NaN where none is.

    Args:
        test: One of `TESTS`.
        runs: Of each condition.
        claims: In the table.
    """

    def power(effect: float) -> float:
        p = test.p(np.random.default_rng(runs), runs, effect)
        return float((p < needed(claims)).mean())

    low, high = test.null, test.most
    if power(high) < POWER:
        return float("nan")
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if power(middle) >= POWER else (middle, high)
    return high


def power_table(runs: int, claims: int) -> pd.DataFrame:
    """A row per test: the smallest difference that so many runs mostly decide."""
    sizes = [detectable(test, runs, claims) for test in TESTS]
    found = [
        "none" if np.isnan(size) else f"{size:.1f} {test.unit}"
        for test, size in zip(TESTS, sizes, strict=True)
    ]
    return pd.DataFrame(
        {
            "test": [test.name for test in TESTS],
            "compares": [test.compares for test in TESTS],
            f"decided in {POWER:.0%} of studies from": found,
        }
    )


def may_disagree(runs: int, claims: int) -> int:
    """Of so many runs, how many may disagree and Wilcoxon's test still decide; -1: it never does.

    At best those that disagree do so least, and take the smallest ranks.
    """
    for number in range(runs + 1):
        sides = np.where(np.arange(runs) < number, -1.0, 1.0)
        p = float(stats.wilcoxon(sides * np.arange(1, runs + 1), alternative="greater").pvalue)
        if p >= needed(claims):
            return number - 1
    return runs


def power_text(runs: int, claims: int) -> str:
    """The power in plain sentences."""
    allowed = may_disagree(runs, claims)
    agree = (
        "never decides"
        if allowed < 0
        else f"decides only what all {runs} agree on"
        if allowed == 0
        else f"decides only where at most {allowed} of {runs} disagree"
    )
    return (
        f"What {runs} runs can decide: a verdict needs p below 0.05/{claims} = "
        f"{needed(claims):.2g}, so that the chance of any wrong verdict in the table is 5 %. "
        f"Wilcoxon's test over {runs} runs {agree}. The table gives the differences, in standard "
        "deviations between runs, that are mostly decided; smaller ones are mostly left undecided, "
        "whether they exist or not. Claims of a range are judged by resampling runs, whose "
        "intervals are somewhat too narrow for few runs."
    )

"""Kinds of claim: what is compared with what, decided before any number is seen.

Each function makes a claim's `weigh`: from the tables of one variant and a random stream to the
evidence, for and against. Names of conditions are those of `PAPER`; several are pooled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from realitygap.studies.paper.persistence import half_life, old_third_curves
from realitygap.studies.paper.statistics import (
    Array,
    ClaimEvidence,
    Statistic,
    brown_forsythe,
    inside,
    interval,
    largest,
    mann_whitney,
    mean,
    outside,
    ratio,
    smallest,
    smallest_ratio,
    spread_ratio,
    wilcoxon,
)
from realitygap.studies.paper.tables import StudyTables

Weigh = Callable[[StudyTables, np.random.Generator], ClaimEvidence]
Names = str | tuple[str, ...]
Both = tuple[float, float]
"""p for a claim and p against it."""


@dataclass(frozen=True)
class Claim:
    """One sentence of section IV, and how it is weighed."""

    key: str
    section: str
    text: str
    statistic: str
    weigh: Weigh


ABOVE_ONE = (1.0, float("inf"))
BELOW_ONE = (float("-inf"), 1.0)


def more(above: Names, below: Names, column: str | tuple[str, str]) -> Weigh:
    """Runs of `above` have more of `column` than those of `below`: ratio of means, Mann-Whitney.

    Several conditions are pooled; two columns are for `above` and `below`.
    """
    first, second = (column, column) if isinstance(column, str) else column

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        samples = [_pool(tables, above, first), _pool(tables, below, second)]
        return _evidence(ratio, samples, random, _greater(*samples), ABOVE_ONE)

    return weigh


def less(below: Names, above: Names, column: str) -> Weigh:
    """Runs of `below` have less of `column`: ratio of means, Mann-Whitney."""

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        samples = [_pool(tables, below, column), _pool(tables, above, column)]
        p = _greater(samples[1], samples[0])
        return _evidence(ratio, samples, random, p, BELOW_ONE)

    return weigh


def all_more(above: Sequence[Names], below: Sequence[Names], column: str) -> Weigh:
    """Each of `above` has more than each of `below`: the least ratio, the largest p.

    Against it: one of `below` has more than one of `above`, the smallest p times their number.
    """

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        high = [_pool(tables, names, column) for names in above]
        low = [_pool(tables, names, column) for names in below]
        p = _all_of([_greater(a, b) for a in high for b in low])
        statistic = partial(smallest_ratio, split=len(high))
        return _evidence(statistic, [*high, *low], random, p, ABOVE_ONE)

    return weigh


def ratio_within(above: Names, below: Names, column: str, region: tuple[float, float]) -> Weigh:
    """The ratio of means lies in a region: shares of resamples outside it, and inside."""

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        samples = [_pool(tables, above, column), _pool(tables, below, column)]
        return _evidence(ratio, samples, random, None, region)

    return weigh


def at_least(above: Names, below: Names, column: str, margin: float) -> Weigh:
    """Not less than `margin` times the other: Mann-Whitney against the scaled sample."""

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        samples = [_pool(tables, above, column), _pool(tables, below, column)]
        p = _greater(samples[0], margin * samples[1])
        return _evidence(ratio, samples, random, p, (margin, float("inf")))

    return weigh


def falls(condition: str, before: str, after: str) -> Weigh:
    """The second column is less than the first in the same runs: ratio of means, Wilcoxon."""

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        samples = [tables.values(condition, after), tables.values(condition, before)]
        p = _positive(samples[1] - samples[0])
        return _evidence(ratio, samples, random, p, BELOW_ONE, paired=True)

    return weigh


def spread_changes(condition: str, before: str, after: str, *, grows: bool) -> Weigh:
    """The second column is more, or less, spread than the first: Brown-Forsythe."""

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        late, early = tables.values(condition, after), tables.values(condition, before)
        p = _wider(late, early) if grows else _wider(early, late)
        region = ABOVE_ONE if grows else BELOW_ONE
        return _evidence(spread_ratio, [late, early], random, p, region, paired=True)

    return weigh


def least_spread(condition: str, others: Sequence[str], column: str) -> Weigh:
    """A condition is less spread than each of the others: the largest ratio, the largest p.

    Against it: it is more spread than one of them, the smallest p times their number.
    """

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        narrow = tables.values(condition, column)
        wide = [tables.values(other, column) for other in others]

        def statistic(samples: Sequence[Array]) -> float:
            return max(spread_ratio((samples[0], other)) for other in samples[1:])

        p = _all_of([_wider(other, narrow) for other in wide])
        return _evidence(statistic, [narrow, *wide], random, p, BELOW_ONE)

    return weigh


def share(names: Names, columns: tuple[str, ...], bound: float, *, above: bool = True) -> Weigh:
    """The mean of columns of each run lies above, or below, a bound: Wilcoxon signed-rank.

    Runs in which it does not occur are left out.
    """

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        values = np.mean([_pool(tables, names, column) for column in columns], axis=0)
        values = values[np.isfinite(values)]
        p = _positive(values - bound if above else bound - values)
        region = (bound, float("inf")) if above else (float("-inf"), bound)
        return _evidence(mean, [values], random, p, region)

    return weigh


def persists(condition: str, scenario: int, region: tuple[float, float]) -> Weigh:
    """Minutes until belief in the old scenario has fallen half-way: shares of resamples."""

    def weigh(tables: StudyTables, random: np.random.Generator) -> ClaimEvidence:
        curves = old_third_curves(tables, condition, scenario)
        half = curves.shape[1] // 2 if curves.ndim == 2 else 0

        def statistic(samples: Sequence[Array]) -> float:
            return half_life(samples[0], half)

        if len(curves) < 2 or half < 4:
            return _nothing(region, len(curves))
        effect = statistic([curves])
        low, high, drawn = interval(statistic, [curves], random, paired=True)
        p = outside(drawn, region), inside(drawn, region)
        return ClaimEvidence(effect, low, high, *p, region, len(curves))

    return weigh


def _greater(more: Array, less: Array) -> Both:
    return mann_whitney(more, less), mann_whitney(less, more)


def _positive(differences: Array) -> Both:
    return wilcoxon(differences), wilcoxon(-differences)


def _wider(wide: Array, narrow: Array) -> Both:
    return brown_forsythe(wide, narrow), brown_forsythe(narrow, wide)


def _all_of(comparisons: Sequence[Both]) -> Both:
    """Of a claim that needs all its comparisons: all for it, or one against it."""
    return largest([p for p, _ in comparisons]), smallest([p for _, p in comparisons])


def _pool(tables: StudyTables, names: Names, column: str) -> Array:
    """One condition's column, or several conditions' one after another."""
    if isinstance(names, str):
        return tables.values(names, column)
    return np.concatenate([tables.values(name, column) for name in names])


def _evidence(
    statistic: Statistic,
    samples: Sequence[Array],
    random: np.random.Generator,
    p: Both | None,
    region: tuple[float, float],
    *,
    paired: bool = False,
) -> ClaimEvidence:
    """Effect, interval and p; without a p of a test, the shares of resamples."""
    runs = min(len(sample) for sample in samples)
    if runs < 2 or not all(np.isfinite(sample).all() for sample in samples):
        return _nothing(region, runs)
    low, high, drawn = interval(statistic, samples, random, paired=paired)
    both = (outside(drawn, region), inside(drawn, region)) if p is None else p
    return ClaimEvidence(statistic(samples), low, high, *both, region, runs)


def _nothing(region: tuple[float, float], runs: int) -> ClaimEvidence:
    """Too little data, or a condition in which it does not occur."""
    nan = float("nan")
    return ClaimEvidence(nan, nan, nan, nan, nan, region, runs)

"""What a claim compares: an estimate with its error, and ranges that mean something.

Every estimand is a number on a scale where differences add up: logarithms of ratios, shares,
minutes. Its error is the jackknife's over runs, which pairs what the same run says twice.

Two are of time: how long a belief outlives the world it was true of, and how soon a swarm earns as
before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from realitygap.studies.paper.tables import Array, StudyTables

BEFORE = 10
"""Minutes before the lamp moves whose mean is the level to fall from; our choice."""
SMOOTH = 3
"""Minutes of running mean over the swarm's mean curve; our choice."""
BACK = 0.8
"""Of the old rate, at which a swarm has adapted; the figure of later work on the same question."""


def old_third_curves(tables: StudyTables, key: str, scenario: int) -> Array:
    """Share of robots that believe a scenario in each minute: (runs, minutes)."""
    believes = tables.generations["s0_third"].eq(scenario).fillna(False).astype(float)
    believing = replace(tables, generations=tables.generations.assign(believes=believes))
    return believing.curves(key, "believes")


def half_life(curves: Array, switch: int) -> float:
    """Minutes after `switch` until the mean curve has fallen half-way to where it ends.

    Args:
        curves: (runs, minutes) share of robots.
        switch: The first minute of the new world.

    Returns:
        The minutes, between two by a straight line, the time left if it never gets there, NaN if
        there was nothing to fall.
    """
    if switch < 1:
        return float("nan")
    mean = curves.mean(axis=0)
    held = float(mean[max(0, switch - BEFORE) : switch].mean())
    left = float(mean[switch + (len(mean) - switch) // 2 :].mean())
    if not held > left:
        return float("nan")
    middle = (held + left) / 2.0
    smooth = _smooth(mean)
    after = smooth[switch:]
    fallen = np.flatnonzero(after <= middle)
    if not fallen.size:
        return float(len(after))
    at = int(fallen[0])
    if not at:
        return 0.0
    return at - float((middle - after[at]) / (after[at - 1] - after[at]))


def recovery(curves: Array, switch: int) -> float:
    """Minutes after `switch` until the mean curve is back at `BACK` of what it was.

    Args:
        curves: (runs, minutes) of what is earned.
        switch: The first minute of the new world.

    Returns:
        From the move to the first such minute after the lowest of the first `BEFORE`; 0 if it never
        falls below, the time left if it never comes back, NaN if nothing was earned.
    """
    if switch < 1:
        return float("nan")
    mean = curves.mean(axis=0)
    enough = BACK * float(mean[max(0, switch - BEFORE) : switch].mean())
    after = _smooth(mean)[switch:]
    if not enough > 0.0:
        return float("nan")
    lowest = int(np.argmin(after[:BEFORE]))
    if after[lowest] >= enough:
        return 0.0
    back = np.flatnonzero(after[lowest:] >= enough)
    return float(lowest + back[0]) if back.size else float(len(after))


def _smooth(mean: Array) -> Array:
    padded = np.pad(mean, SMOOTH // 2, mode="edge")
    return np.convolve(padded, np.ones(SMOOTH) / SMOOTH, "valid")


Names = tuple[str, ...]
Range = tuple[float, float]
Statistic = Callable[[Sequence[Array]], float]
Read = Callable[[StudyTables], list[Array]]
"""Samples, a row per run each."""
Family = Literal["Fig. 6", "Fig. 7", "Fig. 8", "adaptation", "labour", "selection", "number"]

FEWEST = 3
"""Runs below which a jackknife says nothing; our choice."""
INFINITE = float("inf")


@dataclass(frozen=True)
class Comparison:
    """One estimand: what is read from the tables, and the number made of it."""

    read: Read
    statistic: Statistic
    paired: bool
    """The samples are of the same runs."""


@dataclass(frozen=True)
class Claim:
    """One sentence, and how it is weighed; written down before any run that decides it."""

    key: str
    family: Family
    text: str
    estimand: str
    conditions: Names
    """Whose runs it needs."""
    comparisons: tuple[Comparison, ...]
    """The least of them decides: the claim needs all."""
    claimed: Range
    """Estimands for which the sentence is true, as shown."""
    alike: Range | None
    """Estimands that are as good as no difference; None: the claim is itself a range."""
    because: str
    """Why that much is the smallest effect that matters."""
    logarithmic: bool = True
    """The estimand is shown as a ratio and weighed as its logarithm."""


@dataclass(frozen=True)
class Jackknifed:
    """An estimate, on the scale where differences add up."""

    value: float
    error: float
    freedom: float
    """Degrees of freedom of the error (Welch and Satterthwaite)."""
    runs: int
    """In the smallest sample."""


def weigh(comparison: Comparison, tables: StudyTables) -> Jackknifed:
    """The estimate and its jackknife error; NaN where runs are too few or it does not exist."""
    samples = comparison.read(tables)
    if comparison.paired:
        whole = np.all([_whole(sample) for sample in samples], axis=0)
        samples = [sample[whole] for sample in samples]
    else:
        samples = [sample[_whole(sample)] for sample in samples]
    runs = min(len(sample) for sample in samples)
    nothing = Jackknifed(float("nan"), float("nan"), float("nan"), runs)
    if runs < FEWEST:
        return nothing
    groups = (
        [list(range(len(samples)))] if comparison.paired else [[i] for i in range(len(samples))]
    )
    variances, freedoms = [], []
    for group in groups:
        number = len(samples[group[0]])
        left = np.array([_without(comparison.statistic, samples, group, i) for i in range(number)])
        variances.append((number - 1) / number * float(np.sum((left - left.mean()) ** 2)))
        freedoms.append(number - 1)
    total = sum(variances)
    parts = sum(v**2 / f for v, f in zip(variances, freedoms, strict=True))
    freedom = total**2 / parts if parts else float(min(freedoms))
    value = comparison.statistic(samples)
    return (
        Jackknifed(value, float(np.sqrt(total)), freedom, runs) if np.isfinite(value) else nothing
    )


def log_ratio(samples: Sequence[Array]) -> float:
    """Logarithm of the ratio of means."""
    return _log(float(samples[0].mean()), float(samples[1].mean()))


def log_typical(samples: Sequence[Array]) -> float:
    """Logarithm of the ratio of geometric means: for times, which are skewed."""
    return float(np.log(samples[0]).mean() - np.log(samples[1]).mean())


def log_spread(samples: Sequence[Array]) -> float:
    """Logarithm of the ratio of spreads: mean distances of logarithms from their median."""
    logs = [np.log(sample) for sample in samples]
    first, second = (float(np.abs(one - np.median(one)).mean()) for one in logs)
    return _log(first, second)


def mean(samples: Sequence[Array]) -> float:
    """Mean of the first."""
    return float(samples[0].mean())


def ratio(
    above: Names, below: Names, column: str | tuple[str, str], pairs: bool = False
) -> Comparison:
    """Mean of `above` over that of `below`; several conditions are pooled.

    Args:
        above: Conditions.
        below: Conditions; of the same runs if they are the same.
        column: Of both, or one for each.
        pairs: Runs of the two have the same seeds.
    """
    first, second = (column, column) if isinstance(column, str) else column

    def read(tables: StudyTables) -> list[Array]:
        return [_pool(tables, above, first), _pool(tables, below, second)]

    return Comparison(read, log_ratio, pairs or above == below)


def typical(condition: str, columns: tuple[str, str]) -> Comparison:
    """Geometric mean of the first column over that of the second, in the same runs."""

    def read(tables: StudyTables) -> list[Array]:
        return [tables.values(condition, column) for column in columns]

    return Comparison(read, log_typical, True)


def spread(wide: str, narrow: str, columns: tuple[str, str]) -> Comparison:
    """Spread over runs of the first column in `wide`, over that of the second in `narrow`."""

    def read(tables: StudyTables) -> list[Array]:
        return [tables.values(wide, columns[0]), tables.values(narrow, columns[1])]

    return Comparison(read, log_spread, wide == narrow)


def share(names: Names, columns: Names) -> Comparison:
    """Mean of columns of each run; runs in which it does not occur are left out."""

    def read(tables: StudyTables) -> list[Array]:
        return [np.mean([_pool(tables, names, column) for column in columns], axis=0)]

    return Comparison(read, mean, True)


def persistence(condition: str, scenario: int) -> Comparison:
    """Minutes until belief in the old scenario has fallen half-way."""

    def read(tables: StudyTables) -> list[Array]:
        return [old_third_curves(tables, condition, scenario)]

    def statistic(samples: Sequence[Array]) -> float:
        return half_life(samples[0], samples[0].shape[1] // 2)

    return Comparison(read, statistic, True)


def sooner(fewer: str, more: str) -> Comparison:
    """Minutes by which runs of `more` earn as before sooner after the lamp has moved."""

    def read(tables: StudyTables) -> list[Array]:
        return [tables.curves(key, "deposits") for key in (fewer, more)]

    def statistic(samples: Sequence[Array]) -> float:
        fewer_wait, more_wait = (recovery(one, one.shape[1] // 2) for one in samples)
        return fewer_wait - more_wait

    return Comparison(read, statistic, False)


def _pool(tables: StudyTables, names: Names, column: str) -> Array:
    return np.concatenate([tables.values(name, column) for name in names])


def _whole(sample: Array) -> npt.NDArray[np.bool_]:
    finite = np.isfinite(sample)
    return np.asarray(finite if sample.ndim == 1 else finite.all(axis=1), dtype=np.bool_)


def _without(
    statistic: Statistic, samples: Sequence[Array], group: Sequence[int], run: int
) -> float:
    """The statistic without one run of a group of samples."""
    return statistic(
        [np.delete(one, run, axis=0) if i in group else one for i, one in enumerate(samples)]
    )


def _log(above: float, below: float) -> float:
    return float(np.log(above / below)) if above > 0.0 and below > 0.0 else float("nan")

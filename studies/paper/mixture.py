"""Why co-evolution collects more than the fixed positive controller: is it the mixture it runs?

With light at the nest mostly two controllers evolve. Each alone and half of each, as fixed
controllers, tell what dividing the labour brings by itself.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from realitygap.studies.paper.conditions import LABELS
from realitygap.studies.paper.statistics import FEWEST, Array, interval, mann_whitney, wilcoxon
from realitygap.studies.paper.tables import BEHAVIOURS, StudyTables

Row = dict[Hashable, Any]
"""Of `mixture.csv`."""

EVOLVED, MIXED = "at-nest", "fixed-mixture"
ALONE = ("fixed-positive", "fixed-to-and-fro")
COMPARISONS = (
    (ALONE[1], ALONE[0]),
    *((MIXED, alone) for alone in ALONE),
    (EVOLVED, MIXED),
    *((EVOLVED, alone) for alone in ALONE),
)
"""First and second; those of fixed controllers are paired by seed."""


def mixture_table(tables: StudyTables, seed: int) -> pd.DataFrame:
    """`mixture.csv`: items per run of two conditions and their difference, a row per comparison.

    Fixed controllers are compared on the runs that both have; what has no run is left out.

    Returns:
        first, second, food_first, food_second, difference (items), low, high (95 % bootstrap), p
        (two-sided; Wilcoxon for pairs, else Mann-Whitney), runs (of the second), paired.
    """
    food = tables.runs.pivot(index=["variant", "run"], columns="condition", values="food_total")
    rows = []
    for first, second in COMPARISONS:
        paired = first != EVOLVED
        both = food.reindex(columns=[first, second])
        both = both.dropna() if paired else both
        if not both.notna().any().all():
            continue
        samples = [both[name].dropna().to_numpy(dtype=np.float64) for name in (first, second)]
        stream = np.random.SeedSequence(seed, spawn_key=(zlib.crc32(f"{first}-{second}".encode()),))
        low, high, _ = interval(_difference, samples, np.random.default_rng(stream), paired=paired)
        rows.append(
            {
                "first": first,
                "second": second,
                "food_first": samples[0].mean(),
                "food_second": samples[1].mean(),
                "difference": _difference(samples),
                "low": low,
                "high": high,
                "p": _two_sided(*samples, paired=paired),
                "runs": len(samples[1]),
                "paired": paired,
            }
        )
    return pd.DataFrame(rows)


def evolved_table(tables: StudyTables) -> pd.DataFrame:
    """`evolved.csv`: what runs on the robots in the second half with light at the nest.

    Returns:
        carrying_food, without_food, share of deployed controllers, items per generation of 60 s,
        runs.
    """
    generations = tables.generations
    late = generations["minute"] >= tables.minutes / 2.0
    rows = generations[(generations["condition"] == EVOLVED) & late]
    found = []
    for g0, g1 in itertools.product(range(3), range(3)):
        which = (rows["g0_third"] == g0) & (rows["g1_third"] == g1)
        found.append(
            {
                "carrying_food": BEHAVIOURS[g0],
                "without_food": BEHAVIOURS[g1],
                "share": which.sum() / len(rows) if len(rows) else np.nan,
                "items": rows.loc[which, "deposits"].mean(),
                "runs": rows["index"].nunique(),
            }
        )
    return pd.DataFrame(found)


def mixture_text(table: pd.DataFrame, evolved: pd.DataFrame) -> list[str]:
    """What was tried and what came out, whichever way it went."""
    share = evolved.set_index(["carrying_food", "without_food"])["share"]
    found = {(row["first"], row["second"]): row for row in table.to_dict("records")}
    alone = [row for pair, row in found.items() if pair == (ALONE[1], ALONE[0])]
    mixed = [row for (first, _), row in found.items() if first == MIXED]
    evolution = [row for pair, row in found.items() if pair == (EVOLVED, MIXED)]
    return [
        "With light at the nest co-evolution and the fixed positive controller both approach the "
        "lamp with food. Without food the fixed one searches. In the second half of an evolved run "
        f"({evolved['runs'].max()} counted) {share['positive', 'search']:.0%} of the controllers "
        f"do the same, and {share['positive', 'negative']:.0%} leave the lamp instead (“to and "
        "fro”). Each was tried alone as a fixed controller, and half of each; these three have the "
        "same seeds.",
        " ".join(_sentence(row) for row in (*alone, *mixed)),
        _conclusion(mixed),
        *(f"{_sentence(row)} {_remainder(row)}" for row in evolution),
    ]


def _sentence(row: Row) -> str:
    first, second = (LABELS[row[name]] for name in ("first", "second"))
    kind = f"{row['runs']} pairs, " if row["paired"] else ""
    return (
        f"{first} brings {row['food_first']:.0f} items per run and {second.lower()} "
        f"{row['food_second']:.0f}: a difference of {row['difference']:+.0f} ({row['low']:+.0f} to "
        f"{row['high']:+.0f}; {kind}p = {row['p']:.2g})."
    )


def _conclusion(against: Sequence[Row]) -> str:
    """What the mixture's differences from either alone say."""
    if len(against) < len(ALONE) or any(row["runs"] < FEWEST for row in against):
        return "There are too few runs of the mixture to say what dividing the labour brings."
    if all(_sign(row) > 0 for row in against):
        return "The mixture collects more than either alone: dividing the labour pays by itself."
    if any(_sign(row) < 0 for row in against):
        return (
            "The mixture collects less than the better of the two alone: dividing the labour in "
            "halves does not explain why co-evolution collects more."
        )
    return (
        "The mixture does not clearly collect more than the better of the two alone: dividing the "
        "labour in halves is not shown to pay by itself."
    )


def _remainder(row: Row) -> str:
    """What is left for other reasons."""
    if row["runs"] < FEWEST:
        return "So few runs decide nothing of the rest."
    return {
        1: "Something that the fixed mixture lacks brings the rest.",
        0: "Between these two no difference is shown.",
        -1: "Co-evolution has to find its controllers first, which costs it.",
    }[_sign(row)]


def _sign(row: Row) -> int:
    """1 or -1 where the whole interval of the difference is on one side of zero."""
    return int(row["low"] > 0.0) - int(row["high"] < 0.0)


def _difference(samples: Sequence[Array]) -> float:
    return float(samples[0].mean() - samples[1].mean())


def _two_sided(first: Array, second: Array, *, paired: bool) -> float:
    if paired:
        sides = wilcoxon(first - second), wilcoxon(second - first)
    else:
        sides = mann_whitney(first, second), mann_whitney(second, first)
    return min(1.0, 2.0 * min(sides))

"""What evolves with light at the nest: the kinds of robots that the fixed mixtures are made of."""

from __future__ import annotations

import itertools

import numpy as np
import pandas as pd

from realitygap.studies.paper.tables import BEHAVIOURS, StudyTables

EVOLVED = "at-nest"


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


def evolved_text(evolved: pd.DataFrame) -> str:
    """Which kinds were mixed, and why these."""
    share = evolved.set_index(["carrying_food", "without_food"])["share"]
    return (
        "With light at the nest co-evolution and the fixed positive controller both approach the "
        "lamp with food. Without food the fixed one searches. In the second half of an evolved run "
        f"({evolved['runs'].max()} counted) {share['positive', 'search']:.0%} of the controllers "
        f"do the same, and {share['positive', 'negative']:.0%} leave the lamp instead (“to and "
        "fro”). Each was tried alone as a fixed controller, and both mixed five to five and seven "
        "to three, on the same seeds: the last family of claims says what came out."
    )

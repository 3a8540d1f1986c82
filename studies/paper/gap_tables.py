"""The study's tables of the gap in fitness: `gap.csv` and `controllers.csv`."""

from __future__ import annotations

import itertools

import pandas as pd

from realitygap.embedded_sim import SCENARIOS
from realitygap.studies.fitness_gap.anew import PARTS
from realitygap.studies.paper.statistics import Array
from realitygap.studies.paper.tables import BEHAVIOURS


def controllers_table(fresh: Array) -> pd.DataFrame:
    """`controllers.csv`: what each of the nine controllers earns in each simulated scenario."""
    rows = [
        {
            "carrying_food": BEHAVIOURS[g0],
            "without_food": BEHAVIOURS[g1],
            **{name: round(float(fresh[g0, g1, at]), 2) for at, name in enumerate(SCENARIOS)},
        }
        for g0, g1 in itertools.product(range(3), range(3))
    ]
    return pd.DataFrame(rows)


def gap_table(gaps: pd.DataFrame) -> pd.DataFrame:
    """`gap.csv`: mean gap and parts by condition and by third of S0, runs weighing alike."""
    rows = []
    for thirds in (False, True):
        keys = ["variant", "condition", *(["s0_third"] if thirds else [])]
        runs = gaps.groupby([*keys, "index"], sort=False)
        means = runs[["fitness_sim", "fitness_real", "gap", *PARTS]].mean()
        table = means.groupby(level=keys, sort=False).mean().reset_index()
        table["generations"] = gaps.groupby(keys, sort=False).size().to_numpy()
        if not thirds:
            table["s0_third"] = pd.NA
        rows.append(table)
    table = pd.concat([part.astype({"s0_third": "Int8"}) for part in rows], ignore_index=True)
    table.insert(2, "believes", table.pop("s0_third").map(dict(enumerate(SCENARIOS))).fillna("any"))
    return table

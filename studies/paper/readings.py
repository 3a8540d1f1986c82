"""How the paper's ambiguous text may be read, and what each claim owes to the reading.

The text prints a mutation s.d. of 2 on genes of range 1 and no rule for genes that leave it, may
or may not broadcast the S0 that bred the running controller, and gives no figure for the lamp.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from realitygap.embedded_sim.genome import BOUNDINGS
from realitygap.studies.paper.claims import PAPERS
from realitygap.studies.paper.conditions import COEVOLVED, PAPER, Condition
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.verdicts import ALIKE, FAILS, HOLDS, OPEN, alone

STANDARD_DEVIATIONS = (2.0, 0.2, 0.02)
"""Of S0's mutation: as printed, the default, and a tenth of it."""
LAMP_RANGES = (0.6, 1.0, 2.0)
"""m at which the lamp's contrast fades; the nominal lamp has 0.8."""
DEFAULT = "default"
NEUTRAL = "neutral"
LITERAL = "literal"
"""S0 mutates with the printed 2 and moves after the controllers: the 34 s of computing that the
paper reports lie within a generation, so what is deployed at its end was bred under the S0 before.
"""


def _mutations() -> dict[str, dict[str, Any]]:
    return {
        f"sd{sd:g}-{bounding}": {"environment_sd": sd, "bounding": bounding}
        for sd, bounding in itertools.product(STANDARD_DEVIATIONS, BOUNDINGS)
        if (sd, bounding) != (0.2, "clamp")
    }


READINGS: dict[str, dict[str, Any]] = {
    DEFAULT: {},
    **_mutations(),
    LITERAL: {"reading": "literal"},
    NEUTRAL: {"reading": NEUTRAL},
}
"""Variants of the text, and the fields of a run that they change."""
LAMPS: dict[str, dict[str, Any]] = {
    f"lamp{metres:g}": {"lamp_range": metres} for metres in LAMP_RANGES
}
"""Variants of the lamp."""
VARIANTS = (*READINGS, *LAMPS)


def conditions_of(variant: str) -> tuple[Condition, ...]:
    """The co-evolved cases in a variant; fixed controllers only where they can differ."""
    if variant == DEFAULT:
        return PAPER
    cases = COEVOLVED if variant in READINGS else (*COEVOLVED, *PAPER[6:])
    changes = {**READINGS, **LAMPS}[variant]
    return tuple(replace(case, variant=variant, changes=changes) for case in cases)


def reading_conditions() -> tuple[Condition, ...]:
    """The conditions of every variant."""
    return tuple(condition for variant in VARIANTS for condition in conditions_of(variant))


def of_variant(tables: StudyTables, variant: str) -> StudyTables:
    """One variant's tables, with the default's runs where a variant has none of its own."""
    runs, generations = tables.runs, tables.generations
    own = set(runs.loc[runs["variant"] == variant, "condition"])
    shared = set(runs["condition"]) - own

    def pick(table: pd.DataFrame) -> pd.DataFrame:
        mine = table["variant"] == variant
        lent = (table["variant"] == DEFAULT) & table["condition"].isin(shared)
        return table[mine | lent].assign(variant=DEFAULT)

    return StudyTables(pick(runs), pick(generations), tables.minutes)


def weigh_readings(tables: StudyTables) -> pd.DataFrame:
    """`readings.csv` of a short study: every claim in every variant, as if it were the only one."""
    return told({variant: alone(of_variant(tables, variant)) for variant in VARIANTS})


def told(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """`readings.csv`: tables of claims by variant, one below the other."""
    columns = ["claim", "variant", "effect", "low", "high", "runs", "verdict"]
    return pd.concat(
        [table.assign(variant=variant)[columns] for variant, table in tables.items()],
        ignore_index=True,
    )


def depends(weighed: pd.DataFrame) -> pd.DataFrame:
    """Per claim: does it depend on the reading, on the lamp, and does it need selection at all?

    A claim depends on what makes it hold in one variant and fail in another. One that holds
    without selection says nothing of co-evolution.
    """
    table = weighed.pivot(index="claim", columns="variant", values="verdict")
    there = set(table.columns)
    table = table.reindex(index=[claim.key for claim in PAPERS], columns=VARIANTS, fill_value=OPEN)
    selecting = [variant for variant in READINGS if variant != NEUTRAL and variant in there]
    lamps = [variant for variant in (DEFAULT, *LAMPS) if variant in there]
    return pd.DataFrame(
        {
            "claim": table.index,
            "text": [claim.text for claim in PAPERS],
            "default": table[DEFAULT].to_numpy(),
            "on the reading": _varies(table[selecting]),
            "on the lamp": _varies(table[lamps]),
            "without selection": table[NEUTRAL].to_numpy(),
            "says": [
                _says(default, neutral)
                for default, neutral in zip(table[DEFAULT], table[NEUTRAL], strict=True)
            ],
        }
    )


def _varies(table: pd.DataFrame) -> list[str]:
    """Depends, does not (the same everywhere), or open."""
    verdicts = []
    for row in table.to_numpy():
        kinds = set(row)
        if HOLDS in kinds and kinds & {FAILS, ALIKE}:
            verdicts.append("depends")
        else:
            verdicts.append(OPEN if OPEN in kinds else "does not")
    return verdicts


def _says(default: str, neutral: str) -> str:
    """What a claim that holds by default says of selection."""
    if default != HOLDS:
        return "–"
    needs = "needs selection"
    return {HOLDS: "proves nothing", FAILS: needs, ALIKE: needs}.get(neutral, OPEN)


def mean_food(tables: StudyTables) -> pd.DataFrame:
    """Mean items per run, conditions by variants."""
    means = tables.runs.groupby(["condition", "variant"])["food_total"].mean().unstack()
    order = [condition.name for condition in PAPER]
    there = [variant for variant in VARIANTS if variant in means]
    return means.reindex(index=order, columns=there).astype(np.float64)

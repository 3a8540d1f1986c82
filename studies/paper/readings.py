"""How the paper's ambiguous text may be read, and what each claim owes to the reading.

The text prints a mutation s.d. of 2 on genes of range 1 and no rule for genes that leave it, may
or may not broadcast the S0 that bred the running controller, and gives no figure for the lamp.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pandas as pd

from realitygap.embedded_sim.reading import BOUNDINGS
from realitygap.studies.paper.claims import CLAIMS
from realitygap.studies.paper.conditions import COEVOLVED, PAPER, Condition
from realitygap.studies.paper.statistics import FEWEST, ClaimEvidence
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.verdicts import weigh

STANDARD_DEVIATIONS = (2.0, 0.2, 0.02)
"""Of S0's mutation: as printed, the default, and a tenth of it."""
LAMP_RANGES = (0.6, 1.0, 2.0)
"""m at which the lamp's contrast fades; the nominal lamp has 0.8."""
DEFAULT = "default"
NEUTRAL = "neutral"


def _mutations() -> dict[str, dict[str, object]]:
    return {
        f"sd{sd:g}-{bounding}": {"environment_sd": sd, "bounding": bounding}
        for sd, bounding in itertools.product(STANDARD_DEVIATIONS, BOUNDINGS)
        if (sd, bounding) != (0.2, "clamp")
    }


READINGS: dict[str, dict[str, object]] = {
    DEFAULT: {},
    **_mutations(),
    "literal": {"reading": "literal"},
    NEUTRAL: {"reading": NEUTRAL},
}
"""Variants of the text, and the fields of a run that they change."""
LAMPS: dict[str, dict[str, object]] = {
    f"lamp{metres:g}": {"lamp_range": metres} for metres in LAMP_RANGES
}
"""Variants of the lamp."""
VARIANTS = (*READINGS, *LAMPS)


def reading_conditions() -> tuple[Condition, ...]:
    """The co-evolved cases in every variant; fixed controllers only where they can differ."""
    conditions = list(PAPER)
    for variant, changes in {**READINGS, **LAMPS}.items():
        if variant != DEFAULT:
            cases = COEVOLVED if variant in READINGS else (*COEVOLVED, *PAPER[6:])
            conditions += [replace(case, variant=variant, changes=changes) for case in cases]
    return tuple(conditions)


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


def stands(evidence: ClaimEvidence) -> str:
    """Whether the whole interval lies where the claim is true, where it is false, or in both."""
    low, high = evidence.region
    if evidence.runs < FEWEST:
        return "open"
    if low < evidence.low and evidence.high < high:
        return "holds"
    if evidence.high <= low or evidence.low >= high:
        return "fails"
    return "open"


def weigh_readings(tables: StudyTables, seed: int) -> pd.DataFrame:
    """`readings.csv`: every claim in every variant, uncorrected, as the runs are few."""
    rows = []
    for variant in VARIANTS:
        found = weigh(of_variant(tables, variant), seed)
        for claim, evidence in zip(CLAIMS, found, strict=True):
            rows.append(
                {
                    "claim": claim.key,
                    "variant": variant,
                    "effect": evidence.effect,
                    "low": evidence.low,
                    "high": evidence.high,
                    "runs": evidence.runs,
                    "stands": stands(evidence),
                }
            )
    return pd.DataFrame(rows)


def depends(weighed: pd.DataFrame) -> pd.DataFrame:
    """Per claim: does it depend on the reading, on the lamp, and does it need selection at all?

    A claim depends on what makes it hold in one variant and fail in another. One that holds
    without selection says nothing of co-evolution.
    """
    table = weighed.pivot(index="claim", columns="variant", values="stands")
    table = table.reindex(index=[claim.key for claim in CLAIMS], columns=VARIANTS)
    selecting = [variant for variant in READINGS if variant != NEUTRAL]
    return pd.DataFrame(
        {
            "claim": table.index,
            "text": [claim.text for claim in CLAIMS],
            "default": table[DEFAULT].to_numpy(),
            "on the reading": _varies(table[selecting]),
            "on the lamp": _varies(table[[DEFAULT, *LAMPS]]),
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
        if {"holds", "fails"} <= kinds:
            verdicts.append("depends")
        else:
            verdicts.append("open" if "open" in kinds else "does not")
    return verdicts


def _says(default: str, neutral: str) -> str:
    """What a claim that holds by default says of selection."""
    if default != "holds":
        return "–"
    return {"holds": "proves nothing", "fails": "needs selection"}.get(neutral, "open")


def mean_food(tables: StudyTables) -> pd.DataFrame:
    """Mean items per run, conditions by variants."""
    means = tables.runs.groupby(["condition", "variant"])["food_total"].mean().unstack()
    order = [condition.name for condition in PAPER]
    return means.reindex(index=order, columns=list(VARIANTS)).astype(np.float64)

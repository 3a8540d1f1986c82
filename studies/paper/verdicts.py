"""The claims table: every claim weighed, corrected over the whole table, and judged.

A claim is reproduced if chance is unlikely after Holm's correction over the whole table; not
reproduced if the effect's 95 % interval lies wholly where the claim is false; else undecided.
"""

from __future__ import annotations

import zlib

import numpy as np
import pandas as pd

from studies.paper.claims import CLAIMS
from studies.paper.statistics import FEWEST, LEVEL, Evidence, holm
from studies.paper.tables import StudyTables
from studies.paper.weighing import Claim


def weigh_claims(tables: StudyTables, seed: int) -> pd.DataFrame:
    """The claims table, a row per claim in the paper's order.

    Args:
        tables: Of one study and one variant.
        seed: The study's; every claim resamples from a stream of its own.
    """
    evidence = weigh(tables, seed)
    adjusted = holm([found.p for found in evidence])
    return pd.DataFrame([_row(*row) for row in zip(CLAIMS, evidence, adjusted, strict=True)])


def weigh(tables: StudyTables, seed: int) -> list[Evidence]:
    """The evidence for each of `CLAIMS`."""
    evidence = []
    for claim in CLAIMS:
        stream = np.random.SeedSequence(seed, spawn_key=(zlib.crc32(claim.key.encode()),))
        evidence.append(claim.weigh(tables, np.random.default_rng(stream)))
    return evidence


def _row(claim: Claim, evidence: Evidence, p_holm: float) -> dict[str, object]:
    low, high = evidence.region
    return {
        "claim": claim.key,
        "section": claim.section,
        "text": claim.text,
        "statistic": claim.statistic,
        "effect": evidence.effect,
        "low": evidence.low,
        "high": evidence.high,
        "claimed_above": low,
        "claimed_below": high,
        "p": evidence.p,
        "p_holm": p_holm,
        "runs": evidence.runs,
        "verdict": verdict(evidence, p_holm),
    }


def verdict(evidence: Evidence, p_holm: float) -> str:
    """Reproduced, not reproduced or undecided."""
    low, high = evidence.region
    if evidence.runs < FEWEST:
        return "undecided"
    if p_holm < 1.0 - LEVEL and low < evidence.effect < high:
        return "reproduced"
    if evidence.high <= low or evidence.low >= high:
        return "not reproduced"
    return "undecided"

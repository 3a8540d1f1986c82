"""The claims table: every claim weighed, and judged by one rule in both directions.

Reproduced: the estimate lies where the claim is true and the test for it is clear enough for the
whole table. Not reproduced: the estimate lies where it is false and the same test turned round is
as clear. Everything else is undecided.
"""

from __future__ import annotations

import zlib

import numpy as np
import pandas as pd

from realitygap.studies.paper.claims import CLAIMS
from realitygap.studies.paper.notes import labels
from realitygap.studies.paper.statistics import FEWEST, ClaimEvidence, needed
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.weighing import Claim


def weigh_claims(tables: StudyTables, seed: int) -> pd.DataFrame:
    """The claims table, a row per claim in the paper's order.

    Args:
        tables: Of one study and one variant.
        seed: The study's; every claim resamples from a stream of its own.
    """
    evidence = weigh(tables, seed)
    return pd.DataFrame([_row(*row) for row in zip(CLAIMS, evidence, strict=True)])


def weigh(tables: StudyTables, seed: int) -> list[ClaimEvidence]:
    """The evidence for each of `CLAIMS`."""
    evidence = []
    for claim in CLAIMS:
        stream = np.random.SeedSequence(seed, spawn_key=(zlib.crc32(claim.key.encode()),))
        evidence.append(claim.weigh(tables, np.random.default_rng(stream)))
    return evidence


def _row(claim: Claim, evidence: ClaimEvidence) -> dict[str, object]:
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
        "points": evidence.points,
        "p": evidence.p,
        "p_against": evidence.p_against,
        "runs": evidence.runs,
        "verdict": verdict(evidence),
        "notes": "; ".join(labels(claim.key, evidence.region)),
    }


def verdict(evidence: ClaimEvidence, claims: int = len(CLAIMS)) -> str:
    """Reproduced, not reproduced or undecided, in a table of so many claims."""
    if evidence.runs < FEWEST:
        return "undecided"
    if evidence.points == "with" and evidence.p < needed(claims):
        return "reproduced"
    if evidence.points == "against" and evidence.p_against < needed(claims):
        return "not reproduced"
    return "undecided"

"""The claims table: every claim looked at with each batch of runs, and judged by one rule.

An interval that wholly means no difference that matters, that the claim holds, or that it does not
hold, decides; any other leaves the claim open. Its width is that of the sequential boundary.

Notes stand beside a claim: what it owes to choices that were not the paper's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import norm, t

from realitygap.studies.pages.page import VERDICTS
from realitygap.studies.paper.claims import CLAIMS, PAPERS
from realitygap.studies.paper.sequential import WRONG, boundary, looks, shares
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.weighing import Claim, Jackknifed, Range, weigh


@dataclass(frozen=True)
class Note:
    """Said once in full, and beside every claim it concerns by its label."""

    label: str
    text: str
    claims: tuple[str, ...]
    """Keys of the claims concerned."""


LAMP = Note(
    "lamp chosen for this order",
    "The paper gives no figure for its lamp. Ours fades at 0.8 m because ranges of 0.6 to 1 m gave "
    "the paper's order of conditions. That order is therefore no independent finding.",
    (
        *("no-light-worst", "two-best", "light-useful", "opposite-marginal", "negative-excels"),
        *("switches-below-fixed", "first-half-better", "balanced", "opposite-fails"),
        *("keeps-foraging-at-nest-to-opposite", "keeps-foraging-opposite-to-at-nest"),
        *("retrieval-falls-at-nest", "spread-grows-opposite-to-at-nest"),
    ),
)
MUTATION = Note(
    "s.d. 0.2, not 2",
    "S0 mutates with a standard deviation of 0.2; the paper prints 2, on genes of range 1. The "
    "literal reading has the printed one.",
    (
        *("two-best", "nest-converges-faster", "spread-falls-no-light", "spread-falls-at-nest"),
        *("spread-grows-opposite-to-at-nest", "mean-middle-no-light", "mean-middle-opposite"),
        *("no-light-converges", "opposite-fails", "nest-converges", "nest-mean-upper"),
        *("nest-positive", "search-evolves-no-light", "search-evolves-opposite"),
        *("first-half-opposite", "first-half-nest"),
        *("persists-at-nest-to-opposite", "persists-opposite-to-at-nest"),
    ),
)
POOLED = Note(
    "same first halves pooled",
    "Until the lamp moves, at nest → opposite is the same experiment as light at nest, and "
    "opposite → at nest the same as light opposite. Claims about the first half alone pool their "
    "runs.",
    ("nest-converges-faster", "first-half-opposite", "first-half-nest"),
)
NOTES = (LAMP, MUTATION, POOLED)


def labels(claim: str) -> list[str]:
    """Labels of the notes that stand beside a claim, given its key."""
    return [note.label for note in NOTES if claim in note.claims]


HOLDS, FAILS, ALIKE, OPEN = VERDICTS


@dataclass(frozen=True)
class Verdict:
    """A claim at the look that decided it, or at the last one."""

    verdict: str
    effect: float
    low: float
    high: float
    runs: int
    """In the smallest sample."""
    bound: float
    """Standard errors that the interval reaches to either side, of many runs."""


def judge(low: float, high: float, claimed: Range, alike: Range | None) -> str:
    """The three-way rule, the same to both sides."""
    if not np.isfinite([low, high]).all():
        return OPEN
    if alike is not None and alike[0] < low and high < alike[1]:
        return ALIKE
    if claimed[0] < low and high < claimed[1]:
        return HOLDS
    return FAILS if high < claimed[0] or claimed[1] < low else OPEN


def decide(tables: StudyTables, batch: int, claims: Sequence[Claim] = CLAIMS) -> pd.DataFrame:
    """The claims table, a row per claim in the order given.

    Families are tested as Benjamini and Bogomolov (2014) do: in a family the chance of any wrong
    verdict is 5 % times the share of families in which anything is decided.

    Args:
        tables: Of one study and one variant.
        batch: Runs between two looks.
        claims: Those to decide.
    """
    weighed = [_looked(claim, tables, batch) for claim in claims]
    families = [claim.family for claim in claims]
    sizes = {family: families.count(family) for family in families}
    found: list[Verdict] = []
    for selected in range(len(sizes), 0, -1):
        found = []
        for claim, estimates in zip(claims, weighed, strict=True):
            chance = WRONG * selected / len(sizes) / sizes[claim.family]
            found.append(_first(claim, estimates, batch, chance))
        told = {f for f, one in zip(families, found, strict=True) if one.verdict != OPEN}
        if len(told) >= selected:
            break
    return pd.DataFrame([_row(*one) for one in zip(claims, found, strict=True)])


def alone(tables: StudyTables, claims: Sequence[Claim] = PAPERS) -> pd.DataFrame:
    """The claims table of all runs in one look, each claim as if it were the only one."""
    found = []
    for claim in claims:
        estimates = [weigh(one, tables) for one in claim.comparisons]
        found.append(_at(claim, estimates, float(norm.isf(WRONG / 2.0))))
    return pd.DataFrame([_row(*one) for one in zip(claims, found, strict=True)])


def still_open(table: pd.DataFrame, claims: Sequence[Claim] = CLAIMS) -> list[Claim]:
    """The claims that a table leaves open."""
    names = set(table.loc[table["verdict"] == OPEN, "claim"])
    return [claim for claim in claims if claim.key in names]


def _looked(claim: Claim, tables: StudyTables, batch: int) -> list[list[Jackknifed]]:
    """The estimates of a claim's comparisons at every look for which all its runs are there."""
    there = min(tables.whole(name) for name in claim.conditions)
    return [
        [weigh(one, tables.first(runs)) for one in claim.comparisons]
        for runs in looks(batch)
        if runs <= there
    ]


def _first(claim: Claim, looked: list[list[Jackknifed]], batch: int, chance: float) -> Verdict:
    """At the first look that decides, or the last."""
    nothing = float("nan")
    found = Verdict(OPEN, nothing, nothing, nothing, 0, nothing)
    bounds = boundary(shares(batch), chance / 2.0)
    for estimates, bound in zip(looked, bounds, strict=False):
        found = _at(claim, estimates, bound)
        if found.verdict != OPEN:
            break
    return found


def _at(claim: Claim, estimates: list[Jackknifed], bound: float) -> Verdict:
    """At one look, with intervals of `bound` standard errors, more for few runs."""
    runs, chance = min(one.runs for one in estimates), float(norm.sf(bound))
    effect, low, high = (
        min(one.value for one in estimates),
        min(one.value - _reach(one, chance) for one in estimates),
        # any of them that is too small speaks against the claim, at the price of their number
        min(one.value + _reach(one, chance / len(estimates)) for one in estimates),
    )
    if any(np.isnan(one.value) for one in estimates):
        effect = low = high = float("nan")
    elif claim.logarithmic:
        effect, low, high = (float(np.exp(x)) for x in (effect, low, high))
    return Verdict(judge(low, high, claim.claimed, claim.alike), effect, low, high, runs, bound)


def _reach(one: Jackknifed, chance: float) -> float:
    """How far an interval reaches to a side, for a one-sided chance."""
    return float(t.isf(chance, one.freedom)) * one.error


def _row(claim: Claim, found: Verdict) -> dict[str, object]:
    none = (float("nan"), float("nan"))
    return {
        "claim": claim.key,
        "family": claim.family,
        "text": claim.text,
        "estimand": claim.estimand,
        "effect": found.effect,
        "low": found.low,
        "high": found.high,
        "claimed_above": claim.claimed[0],
        "claimed_below": claim.claimed[1],
        "alike_above": (claim.alike or none)[0],
        "alike_below": (claim.alike or none)[1],
        "runs": found.runs,
        "bound": found.bound,
        "verdict": found.verdict,
        "notes": "; ".join(labels(claim.key)),
    }

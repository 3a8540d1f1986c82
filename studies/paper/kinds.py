"""Kinds of claim, and the smallest effects that matter, with reasons from the paper's words."""

from __future__ import annotations

from typing import Any

from realitygap.studies.paper.weighing import (
    INFINITE,
    Claim,
    Comparison,
    Family,
    Names,
    Range,
    ratio,
    share,
)

AMOUNT, AMOUNT_WHY = (
    1.15,
    ('15 %: the paper calls two conditions alike, "as poorly as", whose bars differ by less'),
)
CONVERGED, CONVERGED_WHY = (
    1.25,
    ('a quarter: the paper explains a whole difference in food by "faster convergence"'),
)
SPREAD, SPREAD_WHY = (
    1.5,
    ('half as wide again: "significant growth" that shows in a box plot of ten runs'),
)
MOST, MOST_WHY = (0.4, 0.6), '0.1 about one half: "the majority" is more than half and a little'
MARGINAL = (
    (1.0, 1.25),
    (1.0 / 1.05, 1.05),
    ('"only marginally better": by at most a quarter; below 5 % it is not even marginal'),
)
SEVEN = (3.5, 14.0), '"approximately 7 minutes": within a factor of two'
SLACK = (0.85, INFINITE), '"a continued average rate": at most 15 % less than without light'


def above_one(
    names: tuple[str, Family],
    text: str,
    estimand: str,
    conditions: Names,
    *comparisons: Comparison,
    matters: tuple[float, str] = (AMOUNT, AMOUNT_WHY),
) -> Claim:
    """A claim that a ratio, or the least of several, is above one."""
    least, why = matters
    return Claim(
        names[0],
        names[1],
        text,
        estimand,
        conditions,
        comparisons,
        claimed=(1.0, INFINITE),
        alike=(1.0 / least, least),
        because=why,
    )


def within(
    names: tuple[str, Family],
    text: str,
    estimand: str,
    conditions: Names,
    comparisons: tuple[Comparison, ...],
    claimed: Range,
    why: str,
    **changes: Any,
) -> Claim:
    """A claim that an estimand, or the least of several, lies in a range."""
    values = {"claimed": claimed, "alike": None, "because": why, **changes}
    return Claim(names[0], names[1], text, estimand, conditions, comparisons, **values)


def against_half(
    key: str, text: str, estimand: str, conditions: Names, columns: Names, *, most: bool = True
) -> Claim:
    """A claim that a share is above one half, or below."""
    claimed = (0.5, INFINITE) if most else (-INFINITE, 0.5)
    found = (share(conditions, columns),)
    return within(
        *((key, "Fig. 8"), text, f"{estimand}, against one half", conditions, found, claimed),
        *(MOST_WHY,),
        alike=MOST,
        logarithmic=False,
    )


def food(above: str, below: str) -> Comparison:
    """Food of one condition over that of another."""
    return ratio((above,), (below,), "food_total")

"""Every ordinal claim of the paper's section IV.

Each was written down with its estimand, the range in which it is true, and the smallest effect that
matters, before the runs that decide it.
"""

from __future__ import annotations

from realitygap.embedded_sim import SCENARIOS
from realitygap.studies.paper.kinds import (
    AMOUNT,
    AMOUNT_WHY,
    CONVERGED,
    CONVERGED_WHY,
    MARGINAL,
    SEVEN,
    SLACK,
    SPREAD,
    SPREAD_WHY,
    above_one,
    against_half,
    food,
    within,
)
from realitygap.studies.paper.our_claims import LABOUR
from realitygap.studies.paper.weighing import Names, persistence, ratio, spread, typical

NO_LIGHT: Names = ("no-light", "fixed-search")
WITH_LIGHT: Names = (
    *("at-nest", "opposite", "at-nest-to-opposite", "opposite-to-at-nest"),
    *("fixed-positive", "fixed-negative"),
)
SWITCHES: Names = ("at-nest-to-opposite", "opposite-to-at-nest")
SWITCH_LABELS = ("At nest → opposite", "Opposite → at nest")
FIRST_AT_NEST: Names = ("at-nest", "at-nest-to-opposite")
FIRST_OPPOSITE: Names = ("opposite", "opposite-to-at-nest")
"""The same experiment until the lamp moves: claims about the first half alone pool their runs."""
OPPOSITE, AT_NEST = SCENARIOS.index("opposite"), SCENARIOS.index("at_nest")
ALL_QUARTERS = ("q1", "q2", "q3", "q4")
_FIXED_LIGHT = (
    ("no-light", "without light"),
    ("at-nest", "with light at nest"),
    ("opposite", "with light opposite"),
)


def _quarters(prefix: str, quarters: tuple[str, ...] = ALL_QUARTERS) -> Names:
    return tuple(f"{prefix}_{quarter}" for quarter in quarters)


FOOD = (
    within(
        ("search-equivalent", "Fig. 6"),
        "Without light, co-evolution collects as little as the fixed search controller",
        "food, ratio of means",
        NO_LIGHT,
        (food(*NO_LIGHT),),
        (1.0 / AMOUNT, AMOUNT),
        AMOUNT_WHY,
    ),
    above_one(
        ("no-light-worst", "Fig. 6"),
        "The two conditions without light collect least of all",
        "food, least ratio of the six others to both pooled",
        (*WITH_LIGHT, *NO_LIGHT),
        *(ratio((name,), NO_LIGHT, "food_total") for name in WITH_LIGHT),
    ),
    above_one(
        ("two-best", "Fig. 6"),
        "Light at nest and the fixed positive controller collect most of all",
        "food, least ratio of either to any of the six others",
        (*WITH_LIGHT, *NO_LIGHT),
        *(
            food(best, other)
            for best in ("at-nest", "fixed-positive")
            for other in ("no-light", "opposite", *SWITCHES, "fixed-search", "fixed-negative")
        ),
    ),
    above_one(
        ("light-useful", "Fig. 6"),
        "With light at the nest the swarm collects more than without light",
        "food, ratio of means",
        ("at-nest", "no-light"),
        food("at-nest", "no-light"),
    ),
    within(
        ("opposite-marginal", "Fig. 6"),
        "Light opposite the nest is only marginally better than no light",
        "food, ratio of means to both conditions without light",
        ("opposite", *NO_LIGHT),
        (ratio(("opposite",), NO_LIGHT, "food_total"),),
        MARGINAL[0],
        MARGINAL[2],
        alike=MARGINAL[1],
    ),
    above_one(
        ("negative-excels", "Fig. 6"),
        "The fixed negative controller collects more than co-evolution under the same light",
        "food, ratio of means",
        ("fixed-negative", "opposite"),
        food("fixed-negative", "opposite"),
    ),
    above_one(
        ("switches-below-fixed", "Fig. 6"),
        "Both cases with a moving light collect less than the two better fixed controllers",
        "food, least ratio of either fixed to either case",
        ("fixed-positive", "fixed-negative", *SWITCHES),
        *(food(fixed, case) for fixed in ("fixed-positive", "fixed-negative") for case in SWITCHES),
    ),
    above_one(
        ("first-half-better", "Fig. 6"),
        "At nest → opposite collects more in its first half",
        "food, first half over second, in the same runs",
        (SWITCHES[0],),
        ratio(SWITCHES[:1], SWITCHES[:1], ("food_first", "food_second")),
    ),
    above_one(
        ("balanced", "Fig. 6"),
        "Opposite → at nest is more balanced between halves than at nest → opposite",
        "distance of the first half's share from one half, at nest → opposite over the other",
        SWITCHES,
        ratio(SWITCHES[:1], SWITCHES[1:], "imbalance"),
    ),
    above_one(
        ("nest-converges-faster", "Fig. 6"),
        "In the first half, more robots believe the truth with light at nest than opposite",
        "share of robots in the right third in the second quarter, ratio",
        (*FIRST_AT_NEST, *FIRST_OPPOSITE),
        ratio(FIRST_AT_NEST, FIRST_OPPOSITE, ("robots_at_nest_q2", "robots_opposite_q2")),
        matters=(CONVERGED, CONVERGED_WHY),
    ),
)

RATE = (
    *(
        above_one(
            (f"retrieval-falls-{name}", "Fig. 7"),
            f"Items come faster to the nest after half-time {where}",
            "time from pick-up to nest, first half over second in the same runs, geometric means",
            (name,),
            typical(name, ("retrieval_first", "retrieval_second")),
        )
        for name, where in _FIXED_LIGHT
    ),
    *(
        above_one(
            (f"spread-falls-{name}", "Fig. 7"),
            f"Runs differ less in retrieval time after half-time {where}",
            "spread over runs of retrieval time's logarithm, first half over second, paired",
            (name,),
            spread(name, name, ("retrieval_first", "retrieval_second")),
            matters=(SPREAD, SPREAD_WHY),
        )
        for name, where in _FIXED_LIGHT
    ),
    above_one(
        ("nest-least-spread", "Fig. 7"),
        "Runs with light at nest differ less in retrieval time than the other two fixed lights",
        "spread over runs of retrieval time's logarithm, least ratio of another to it",
        ("at-nest", "no-light", "opposite"),
        *(
            spread(other, "at-nest", ("retrieval_total", "retrieval_total"))
            for other in ("no-light", "opposite")
        ),
        matters=(SPREAD, SPREAD_WHY),
    ),
    *(
        within(
            (f"keeps-foraging-{name}", "adaptation"),
            f"{label}: the swarm is foraging again in the last quarter",
            "food of the last quarter, ratio of means to that without light",
            (name, "no-light"),
            (ratio((name,), ("no-light",), "food_q4"),),
            *SLACK,
        )
        for name, label in zip(SWITCHES, SWITCH_LABELS, strict=True)
    ),
    *(
        above_one(
            (f"spread-grows-{name}", "Fig. 7"),
            f"{label}: runs differ more in retrieval time after the light has moved",
            "spread over runs of retrieval time's logarithm, second half over first, paired",
            (name,),
            spread(name, name, ("retrieval_second", "retrieval_first")),
            matters=(SPREAD, SPREAD_WHY),
        )
        for name, label in zip(SWITCHES, SWITCH_LABELS, strict=True)
    ),
    above_one(
        ("segregation", "adaptation"),
        "After opposite → at nest, robots with positive phototaxis work in seclusion",
        "other robots within 0.2 m in the third quarter, of those carrying food away from the "
        "light over those carrying it towards the light, in the same runs",
        (SWITCHES[1],),
        ratio(SWITCHES[1:], SWITCHES[1:], ("near_negative", "near_positive")),
        matters=(CONVERGED, 'a quarter: "relative seclusion" is less company that can be seen'),
    ),
)

GENE = (
    *(
        against_half(
            f"mean-middle-{name}",
            f"Mean S0 spends most of its time in the middle region {where}",
            "share of minutes",
            (name,),
            _quarters("mean_none"),
        )
        for name, where in (_FIXED_LIGHT[0], _FIXED_LIGHT[2])
    ),
    against_half(
        "no-light-converges",
        "Without light most robots end up believing in no light",
        "share of robots in the last quarter",
        ("no-light",),
        ("robots_none_q4",),
    ),
    against_half(
        "opposite-fails",
        "With light opposite the swarm fails to converge on it",
        "share of robots that believe it in the last quarter",
        ("opposite",),
        ("robots_opposite_q4",),
        most=False,
    ),
    against_half(
        "nest-converges",
        "With light at nest most robots end up believing in it",
        "share of robots in the last quarter",
        ("at-nest",),
        ("robots_at_nest_q4",),
    ),
    against_half(
        "nest-mean-upper",
        "With light at nest mean S0 occupies the upper region",
        "share of minutes of the second half",
        ("at-nest",),
        _quarters("mean_at_nest", ("q3", "q4")),
    ),
    against_half(
        "nest-positive",
        "With light at nest the swarm carries food towards the light",
        "share of robots with positive G0 in the second half",
        ("at-nest",),
        _quarters("g0_positive", ("q3", "q4")),
    ),
    *(
        against_half(
            f"search-evolves-{name}",
            f"The controllers evolved {where} are based on search",
            "share of robots with G0 of search in the second half",
            (name,),
            _quarters("g0_search", ("q3", "q4")),
        )
        for name, where in (_FIXED_LIGHT[0], _FIXED_LIGHT[2])
    ),
    against_half(
        "first-half-opposite",
        "Opposite → at nest converges on the light opposite before it moves",
        "share of robots in the second quarter",
        FIRST_OPPOSITE,
        ("robots_opposite_q2",),
    ),
    against_half(
        "first-half-nest",
        "At nest → opposite converges on the light at nest before it moves",
        "share of robots in the second quarter",
        FIRST_AT_NEST,
        ("robots_at_nest_q2",),
    ),
    *(
        within(
            (f"persists-{name}", "adaptation"),
            f"{label}: the old convergence lasts about 7 minutes after the light has moved",
            "minutes until the share of robots in the old third is half-way to its end",
            (name,),
            (persistence(name, scenario),),
            *SEVEN,
            logarithmic=False,
        )
        for name, label, scenario in zip(SWITCHES, SWITCH_LABELS, (AT_NEST, OPPOSITE), strict=True)
    ),
)

PAPERS = (*FOOD, *RATE, *GENE)
"""The paper's, in its order."""

CLAIMS = (*PAPERS, *LABOUR)
"""Those that the default reading decides."""

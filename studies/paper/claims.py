"""Every ordinal claim of the paper's section IV, and ours on the division of labour.

Each was written down with its estimand, the range in which it is true, and the smallest effect that
matters, before the runs that decide it.
"""

from __future__ import annotations

import itertools
from typing import Any

from realitygap.embedded_sim import SCENARIOS
from realitygap.studies.paper.weighing import (
    INFINITE,
    Claim,
    Comparison,
    Family,
    Names,
    Range,
    persistence,
    ratio,
    share,
    sooner,
    spread,
    typical,
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


def _more(
    names: tuple[str, Family],
    text: str,
    estimand: str,
    conditions: Names,
    *comparisons: Comparison,
    matters: tuple[float, str] = (AMOUNT, AMOUNT_WHY),
) -> Claim:
    """A ratio, or the least of several, is above one."""
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


def _within(
    names: tuple[str, Family],
    text: str,
    estimand: str,
    conditions: Names,
    comparisons: tuple[Comparison, ...],
    claimed: Range,
    why: str,
    **changes: Any,
) -> Claim:
    """An estimand lies in a range."""
    values = {"claimed": claimed, "alike": None, "because": why, **changes}
    return Claim(names[0], names[1], text, estimand, conditions, comparisons, **values)


def _share(
    key: str, text: str, estimand: str, conditions: Names, columns: Names, *, most: bool = True
) -> Claim:
    """A share is above one half, or below."""
    claimed = (0.5, INFINITE) if most else (-INFINITE, 0.5)
    found = (share(conditions, columns),)
    return _within(
        *((key, "Fig. 8"), text, f"{estimand}, against one half", conditions, found, claimed),
        *(MOST_WHY,),
        alike=MOST,
        logarithmic=False,
    )


def _food(above: str, below: str) -> Comparison:
    return ratio((above,), (below,), "food_total")


FOOD = (
    _within(
        ("search-equivalent", "Fig. 6"),
        "Without light, co-evolution collects as little as the fixed search controller",
        "food, ratio of means",
        NO_LIGHT,
        (_food(*NO_LIGHT),),
        (1.0 / AMOUNT, AMOUNT),
        AMOUNT_WHY,
    ),
    _more(
        ("no-light-worst", "Fig. 6"),
        "The two conditions without light collect least of all",
        "food, least ratio of the six others to both pooled",
        (*WITH_LIGHT, *NO_LIGHT),
        *(ratio((name,), NO_LIGHT, "food_total") for name in WITH_LIGHT),
    ),
    _more(
        ("two-best", "Fig. 6"),
        "Light at nest and the fixed positive controller collect most of all",
        "food, least ratio of either to any of the six others",
        (*WITH_LIGHT, *NO_LIGHT),
        *(
            _food(best, other)
            for best in ("at-nest", "fixed-positive")
            for other in ("no-light", "opposite", *SWITCHES, "fixed-search", "fixed-negative")
        ),
    ),
    _more(
        ("light-useful", "Fig. 6"),
        "With light at the nest the swarm collects more than without light",
        "food, ratio of means",
        ("at-nest", "no-light"),
        _food("at-nest", "no-light"),
    ),
    _within(
        ("opposite-marginal", "Fig. 6"),
        "Light opposite the nest is only marginally better than no light",
        "food, ratio of means to both conditions without light",
        ("opposite", *NO_LIGHT),
        (ratio(("opposite",), NO_LIGHT, "food_total"),),
        MARGINAL[0],
        MARGINAL[2],
        alike=MARGINAL[1],
    ),
    _more(
        ("negative-excels", "Fig. 6"),
        "The fixed negative controller collects more than co-evolution under the same light",
        "food, ratio of means",
        ("fixed-negative", "opposite"),
        _food("fixed-negative", "opposite"),
    ),
    _more(
        ("switches-below-fixed", "Fig. 6"),
        "Both cases with a moving light collect less than the two better fixed controllers",
        "food, least ratio of either fixed to either case",
        ("fixed-positive", "fixed-negative", *SWITCHES),
        *(
            _food(fixed, case)
            for fixed in ("fixed-positive", "fixed-negative")
            for case in SWITCHES
        ),
    ),
    _more(
        ("first-half-better", "Fig. 6"),
        "At nest → opposite collects more in its first half",
        "food, first half over second, in the same runs",
        (SWITCHES[0],),
        ratio(SWITCHES[:1], SWITCHES[:1], ("food_first", "food_second")),
    ),
    _more(
        ("balanced", "Fig. 6"),
        "Opposite → at nest is more balanced between halves than at nest → opposite",
        "distance of the first half's share from one half, at nest → opposite over the other",
        SWITCHES,
        ratio(SWITCHES[:1], SWITCHES[1:], "imbalance"),
    ),
    _more(
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
        _more(
            (f"retrieval-falls-{name}", "Fig. 7"),
            f"Items come faster to the nest after half-time {where}",
            "time from pick-up to nest, first half over second in the same runs, geometric means",
            (name,),
            typical(name, ("retrieval_first", "retrieval_second")),
        )
        for name, where in _FIXED_LIGHT
    ),
    *(
        _more(
            (f"spread-falls-{name}", "Fig. 7"),
            f"Runs differ less in retrieval time after half-time {where}",
            "spread over runs of retrieval time's logarithm, first half over second, paired",
            (name,),
            spread(name, name, ("retrieval_first", "retrieval_second")),
            matters=(SPREAD, SPREAD_WHY),
        )
        for name, where in _FIXED_LIGHT
    ),
    _more(
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
        _within(
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
        _more(
            (f"spread-grows-{name}", "Fig. 7"),
            f"{label}: runs differ more in retrieval time after the light has moved",
            "spread over runs of retrieval time's logarithm, second half over first, paired",
            (name,),
            spread(name, name, ("retrieval_second", "retrieval_first")),
            matters=(SPREAD, SPREAD_WHY),
        )
        for name, label in zip(SWITCHES, SWITCH_LABELS, strict=True)
    ),
    _more(
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
        _share(
            f"mean-middle-{name}",
            f"Mean S0 spends most of its time in the middle region {where}",
            "share of minutes",
            (name,),
            _quarters("mean_none"),
        )
        for name, where in (_FIXED_LIGHT[0], _FIXED_LIGHT[2])
    ),
    _share(
        "no-light-converges",
        "Without light most robots end up believing in no light",
        "share of robots in the last quarter",
        ("no-light",),
        ("robots_none_q4",),
    ),
    _share(
        "opposite-fails",
        "With light opposite the swarm fails to converge on it",
        "share of robots that believe it in the last quarter",
        ("opposite",),
        ("robots_opposite_q4",),
        most=False,
    ),
    _share(
        "nest-converges",
        "With light at nest most robots end up believing in it",
        "share of robots in the last quarter",
        ("at-nest",),
        ("robots_at_nest_q4",),
    ),
    _share(
        "nest-mean-upper",
        "With light at nest mean S0 occupies the upper region",
        "share of minutes of the second half",
        ("at-nest",),
        _quarters("mean_at_nest", ("q3", "q4")),
    ),
    _share(
        "nest-positive",
        "With light at nest the swarm carries food towards the light",
        "share of robots with positive G0 in the second half",
        ("at-nest",),
        _quarters("g0_positive", ("q3", "q4")),
    ),
    *(
        _share(
            f"search-evolves-{name}",
            f"The controllers evolved {where} are based on search",
            "share of robots with G0 of search in the second half",
            (name,),
            _quarters("g0_search", ("q3", "q4")),
        )
        for name, where in (_FIXED_LIGHT[0], _FIXED_LIGHT[2])
    ),
    _share(
        "first-half-opposite",
        "Opposite → at nest converges on the light opposite before it moves",
        "share of robots in the second quarter",
        FIRST_OPPOSITE,
        ("robots_opposite_q2",),
    ),
    _share(
        "first-half-nest",
        "At nest → opposite converges on the light at nest before it moves",
        "share of robots in the second quarter",
        FIRST_AT_NEST,
        ("robots_at_nest_q2",),
    ),
    *(
        _within(
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

ALONE: Names = ("fixed-positive", "fixed-to-and-fro")
MIXTURES = (("fixed-mixture", "five and five"), ("fixed-mixture-7-3", "seven and three"))
LABOUR = (
    _more(
        ("evolved-beats-fixed", "labour"),
        "Co-evolution with light at nest collects more than the fixed positive controller",
        "food, ratio of means",
        ("at-nest", "fixed-positive"),
        _food("at-nest", "fixed-positive"),
    ),
    *(
        _more(
            (f"{key.removeprefix('fixed-')}-pays", "labour"),
            f"Fixed robots of the two evolved kinds, {parts}, collect more than either kind alone",
            "food, least ratio to either alone, pairs of the same seed",
            (key, *ALONE),
            *(ratio((key,), (alone,), "food_total", pairs=True) for alone in ALONE),
        )
        for key, parts in MIXTURES
    ),
    _more(
        ("evolution-costs", "labour"),
        "The fixed mixture collects more than co-evolution, which has to find it",
        "food, least ratio of either mixture to co-evolution with light at nest",
        ("at-nest", *(key for key, _ in MIXTURES)),
        *(_food(key, "at-nest") for key, _ in MIXTURES),
    ),
)
"""Ours: is it dividing the labour that beats the fixed positive controller?"""

INFORMATIVE = (("at-nest", "with light at nest"), ("no-light", "without light"))
"""Where believing wrongly costs food, and where it cannot: nothing there is to be believed in."""
SELECTION = (
    *(
        _more(
            (f"truth-pays-{name}", "selection"),
            f"A robot that believes the truth earns more {where}",
            "fitness in reality in the second half, of right beliefs over wrong, in the same runs",
            (name,),
            ratio((name,), (name,), ("earned_right", "earned_wrong")),
        )
        for name, where in INFORMATIVE
    ),
    *(
        _more(
            (f"selection-finds-{name}", "selection"),
            f"Selection by foraging makes more robots believe the truth {where}",
            "share of robots in the right third in the last quarter, ratio to neutral",
            (name, f"neutral.{name}"),
            ratio((name,), (f"neutral.{name}",), f"robots_{scenario}_q4"),
            matters=(CONVERGED, CONVERGED_WHY),
        )
        for (name, where), scenario in zip(INFORMATIVE, ("at_nest", "none"), strict=True)
    ),
    _more(
        ("selection-feeds", "selection"),
        "Selection of simulators by foraging brings more food with light at the nest",
        "food, ratio of means to neutral",
        ("at-nest", "neutral.at-nest"),
        _food("at-nest", "neutral.at-nest"),
    ),
)
"""Ours: can simulators converge where reality does not tell them apart, and what is it worth?"""

SIZES = ("robots5", "default", "robots20", "robots40")
_MOVED = tuple(f"{size}.{SWITCHES[1]}".removeprefix("default.") for size in SIZES)
NUMBER = tuple(
    _within(
        (key, "number"),
        text,
        "minutes from the move, opposite → at nest, to 80 % of the old rate: difference",
        tuple({name: None for pair in pairs for name in pair}),
        tuple(sooner(*pair) for pair in pairs),
        (0.0, INFINITE),
        "a minute: no robot can change its controller in less than a generation",
        alike=(-1.0, 1.0),
        logarithmic=False,
    )
    for key, text, pairs in (
        ("forty-adapt-faster", "Forty robots adapt faster than five", ((_MOVED[0], _MOVED[3]),)),
        (
            "each-doubling-faster",
            "Each doubling of the robots, from five to forty, makes them adapt faster",
            tuple(itertools.pairwise(_MOVED)),
        ),
    )
)
"""Ours: do more robots adapt faster, in an arena of the same density?"""

CLAIMS = (*PAPERS, *LABOUR)
"""Those that the default reading decides."""

"""Claims of our own: on dividing the labour, on selection, and on the number of robots."""

from __future__ import annotations

import itertools

from realitygap.studies.paper.kinds import (
    CONVERGED,
    CONVERGED_WHY,
    above_one,
    food,
    within,
)
from realitygap.studies.paper.weighing import INFINITE, Names, ratio, sooner

ALONE: Names = ("fixed-positive", "fixed-to-and-fro")
MIXTURES = (("fixed-mixture", "five and five"), ("fixed-mixture-7-3", "seven and three"))
LABOUR = (
    above_one(
        ("evolved-beats-fixed", "labour"),
        "Co-evolution with light at nest collects more than the fixed positive controller",
        "food, ratio of means",
        ("at-nest", "fixed-positive"),
        food("at-nest", "fixed-positive"),
    ),
    *(
        above_one(
            (f"{key.removeprefix('fixed-')}-pays", "labour"),
            f"Fixed robots of the two evolved kinds, {parts}, collect more than either kind alone",
            "food, least ratio to either alone, pairs of the same seed",
            (key, *ALONE),
            *(ratio((key,), (alone,), "food_total", pairs=True) for alone in ALONE),
        )
        for key, parts in MIXTURES
    ),
    above_one(
        ("evolution-costs", "labour"),
        "The fixed mixture collects more than co-evolution, which has to find it",
        "food, least ratio of either mixture to co-evolution with light at nest",
        ("at-nest", *(key for key, _ in MIXTURES)),
        *(food(key, "at-nest") for key, _ in MIXTURES),
    ),
)
"""Ours: is it dividing the labour that beats the fixed positive controller?"""

INFORMATIVE = (("at-nest", "with light at nest"), ("no-light", "without light"))
"""Where believing wrongly costs food, and where it cannot: nothing there is to be believed in."""
SELECTION = (
    *(
        above_one(
            (f"truth-pays-{name}", "selection"),
            f"A robot that believes the truth earns more {where}",
            "fitness in reality in the second half, of right beliefs over wrong, in the same runs",
            (name,),
            ratio((name,), (name,), ("earned_right", "earned_wrong")),
        )
        for name, where in INFORMATIVE
    ),
    *(
        above_one(
            (f"selection-finds-{name}", "selection"),
            f"Selection by foraging makes more robots believe the truth {where}",
            "share of robots in the right third in the last quarter, ratio to neutral",
            (name, f"neutral.{name}"),
            ratio((name,), (f"neutral.{name}",), f"robots_{scenario}_q4"),
            matters=(CONVERGED, CONVERGED_WHY),
        )
        for (name, where), scenario in zip(INFORMATIVE, ("at_nest", "none"), strict=True)
    ),
    above_one(
        ("selection-feeds", "selection"),
        "Selection of simulators by foraging brings more food with light at the nest",
        "food, ratio of means to neutral",
        ("at-nest", "neutral.at-nest"),
        food("at-nest", "neutral.at-nest"),
    ),
)
"""Ours: can simulators converge where reality does not tell them apart, and what is it worth?"""

MOVED_CASE = "opposite-to-at-nest"
SIZES = ("robots5", "default", "robots20", "robots40")
_MOVED = tuple(f"{size}.{MOVED_CASE}".removeprefix("default.") for size in SIZES)
NUMBER = tuple(
    within(
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

"""Every ordinal claim of the paper's section IV, each with a statistic decided beforehand."""

from __future__ import annotations

from realitygap.embedded_sim import SCENARIOS
from realitygap.studies.paper.weighing import (
    Claim,
    all_more,
    at_least,
    falls,
    least_spread,
    less,
    more,
    persists,
    ratio_within,
    share,
    spread_changes,
)

EQUIVALENT = (0.85, 1.0 / 0.85)
"""Ratio of means called "as poorly as": within 15 %, our choice."""
MARGINAL = (1.0, 1.25)
"""Ratio of means called "only marginally better": a gain of at most a quarter, our choice."""
ABOUT_SEVEN = (3.5, 14.0)
"""Minutes called "approximately 7": within a factor of two, our choice."""
MOST = 0.5
"""Share of robots, or of minutes, called convergence."""

NO_LIGHT = ("no-light", "fixed-search")
WITH_LIGHT = (
    *("at-nest", "opposite", "at-nest-to-opposite", "opposite-to-at-nest"),
    *("fixed-positive", "fixed-negative"),
)
SWITCHES = ("at-nest-to-opposite", "opposite-to-at-nest")
OPPOSITE, AT_NEST = SCENARIOS.index("opposite"), SCENARIOS.index("at_nest")
ALL_QUARTERS = ("q1", "q2", "q3", "q4")


def _quarters(prefix: str, quarters: tuple[str, ...] = ALL_QUARTERS) -> tuple[str, ...]:
    return tuple(f"{prefix}_{quarter}" for quarter in quarters)


FOOD = (
    Claim(
        "search-equivalent",
        "IV-A",
        "Without light, co-evolution collects as little as the fixed search controller",
        "food, ratio of means within 15 %",
        ratio_within("no-light", "fixed-search", "food_total", EQUIVALENT),
    ),
    Claim(
        "no-light-worst",
        "IV-A",
        "The two conditions without light collect least of all",
        "food, least ratio of the six others to both pooled; Mann-Whitney, largest p",
        all_more(WITH_LIGHT, (NO_LIGHT,), "food_total"),
    ),
    Claim(
        "two-best",
        "IV-A",
        "Light at nest and the fixed positive controller collect most of all",
        "food, least ratio of either to any of the six others; Mann-Whitney, largest p",
        all_more(
            ("at-nest", "fixed-positive"),
            ("no-light", "opposite", *SWITCHES, "fixed-search", "fixed-negative"),
            "food_total",
        ),
    ),
    Claim(
        "light-useful",
        "IV-A",
        "With light at the nest the swarm collects more than without light",
        "food, ratio of means; Mann-Whitney",
        more("at-nest", "no-light", "food_total"),
    ),
    Claim(
        "opposite-marginal",
        "IV-A",
        "Light opposite the nest is only marginally better than no light",
        "food, ratio of means to both conditions without light between 1 and 1.25",
        ratio_within("opposite", NO_LIGHT, "food_total", MARGINAL),
    ),
    Claim(
        "negative-excels",
        "IV-A",
        "The fixed negative controller collects more than co-evolution under the same light",
        "food, ratio of means; Mann-Whitney",
        more("fixed-negative", "opposite", "food_total"),
    ),
    Claim(
        "switches-below-fixed",
        "IV-A",
        "Both cases with a moving light collect less than the two better fixed controllers",
        "food, least ratio of either fixed to either case; Mann-Whitney, largest p",
        all_more(("fixed-positive", "fixed-negative"), SWITCHES, "food_total"),
    ),
    Claim(
        "first-half-better",
        "IV-A",
        "At nest → opposite collects more in its first half",
        "food, second half over first; Wilcoxon",
        falls("at-nest-to-opposite", "food_first", "food_second"),
    ),
    Claim(
        "balanced",
        "IV-A",
        "Opposite → at nest is more balanced between halves than at nest → opposite",
        "distance of the first half's share from one half, ratio of means; Mann-Whitney",
        less("opposite-to-at-nest", "at-nest-to-opposite", "imbalance"),
    ),
    Claim(
        "nest-converges-faster",
        "IV-A",
        "In the first half, more robots believe the truth with light at nest than opposite",
        "share of robots in the right third in the second quarter, ratio; Mann-Whitney",
        more(
            ("at-nest", "at-nest-to-opposite"),
            ("opposite", "opposite-to-at-nest"),
            ("robots_at_nest_q2", "robots_opposite_q2"),
        ),
    ),
)

_FIXED_LIGHT = (
    ("no-light", "without light"),
    ("at-nest", "with light at nest"),
    ("opposite", "with light opposite"),
)

RATE = (
    *(
        Claim(
            f"retrieval-falls-{name}",
            "IV-B",
            f"Items come faster to the nest after half-time {where}",
            "mean time from pick-up to nest, second half over first; Wilcoxon",
            falls(name, "retrieval_first", "retrieval_second"),
        )
        for name, where in _FIXED_LIGHT
    ),
    *(
        Claim(
            f"spread-falls-{name}",
            "IV-B",
            f"Runs differ less in retrieval time after half-time {where}",
            "spread of retrieval time over runs, second half over first; Brown-Forsythe",
            spread_changes(name, "retrieval_first", "retrieval_second", grows=False),
        )
        for name, where in _FIXED_LIGHT
    ),
    Claim(
        "nest-least-spread",
        "IV-B",
        "Runs with light at nest differ less in retrieval time than the other two fixed lights",
        "spread of retrieval time, largest ratio; Brown-Forsythe, largest p",
        least_spread("at-nest", ("no-light", "opposite"), "retrieval_total"),
    ),
    *(
        Claim(
            f"keeps-foraging-{name}",
            "IV-B",
            f"{label}: the swarm is foraging again in the last quarter",
            "food of the last quarter at least 0.85 of that without light; Mann-Whitney",
            at_least(name, "no-light", "food_q4", 0.85),
        )
        for name, label in zip(SWITCHES, ("At nest → opposite", "Opposite → at nest"), strict=True)
    ),
    *(
        Claim(
            f"spread-grows-{name}",
            "IV-B",
            f"{label}: runs differ more in retrieval time after the light has moved",
            "spread of retrieval time over runs, second half over first; Brown-Forsythe",
            spread_changes(name, "retrieval_first", "retrieval_second", grows=True),
        )
        for name, label in zip(SWITCHES, ("At nest → opposite", "Opposite → at nest"), strict=True)
    ),
    Claim(
        "segregation",
        "IV-B",
        "After opposite → at nest, robots with positive phototaxis work in seclusion",
        "robots heard in a generation of the third quarter, those carrying food towards the light "
        "minus those carrying it away; Wilcoxon (a stand-in: positions are not kept)",
        share("opposite-to-at-nest", ("heard_positive_minus_negative",), 0.0, above=False),
    ),
)

GENE = (
    *(
        Claim(
            f"mean-middle-{name}",
            "IV-C",
            f"Mean S0 spends most of its time in the middle region {where}",
            "share of minutes, above one half; Wilcoxon",
            share(name, _quarters("mean_none"), MOST),
        )
        for name, where in (_FIXED_LIGHT[0], _FIXED_LIGHT[2])
    ),
    Claim(
        "no-light-converges",
        "IV-C",
        "Without light most robots end up believing in no light",
        "share of robots in the last quarter, above one half; Wilcoxon",
        share("no-light", ("robots_none_q4",), MOST),
    ),
    Claim(
        "opposite-fails",
        "IV-C",
        "With light opposite the swarm fails to converge on it",
        "share of robots that believe it in the last quarter, below one half; Wilcoxon",
        share("opposite", ("robots_opposite_q4",), MOST, above=False),
    ),
    Claim(
        "nest-converges",
        "IV-C",
        "With light at nest most robots end up believing in it",
        "share of robots in the last quarter, above one half; Wilcoxon",
        share("at-nest", ("robots_at_nest_q4",), MOST),
    ),
    Claim(
        "nest-mean-upper",
        "IV-C",
        "With light at nest mean S0 occupies the upper region",
        "share of minutes of the second half, above one half; Wilcoxon",
        share("at-nest", _quarters("mean_at_nest", ("q3", "q4")), MOST),
    ),
    Claim(
        "nest-positive",
        "IV-C",
        "With light at nest the swarm carries food towards the light",
        "share of robots with positive G0 in the second half, above one half; Wilcoxon",
        share("at-nest", _quarters("g0_positive", ("q3", "q4")), MOST),
    ),
    *(
        Claim(
            f"search-evolves-{name}",
            "IV-C",
            f"The controllers evolved {where} are based on search",
            "share of robots with G0 of search in the second half, above one half; Wilcoxon",
            share(name, _quarters("g0_search", ("q3", "q4")), MOST),
        )
        for name, where in (_FIXED_LIGHT[0], _FIXED_LIGHT[2])
    ),
    Claim(
        "first-half-opposite",
        "IV-C",
        "Opposite → at nest converges on the light opposite before it moves",
        "share of robots in the second quarter, above one half; Wilcoxon",
        share(("opposite", "opposite-to-at-nest"), ("robots_opposite_q2",), MOST),
    ),
    Claim(
        "first-half-nest",
        "IV-C",
        "At nest → opposite converges on the light at nest before it moves",
        "share of robots in the second quarter, above one half; Wilcoxon",
        share(("at-nest", "at-nest-to-opposite"), ("robots_at_nest_q2",), MOST),
    ),
    *(
        Claim(
            f"persists-{name}",
            "IV-C",
            f"{label}: the old convergence lasts about 7 minutes after the light has moved",
            "minutes until the share of robots in the old third is half-way to its end, "
            "between 3.5 and 14",
            persists(name, scenario, ABOUT_SEVEN),
        )
        for name, label, scenario in (
            (SWITCHES[0], "At nest → opposite", AT_NEST),
            (SWITCHES[1], "Opposite → at nest", OPPOSITE),
        )
    ),
)

CLAIMS = (*FOOD, *RATE, *GENE)

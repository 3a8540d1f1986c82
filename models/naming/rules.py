"""Every number of naming that was tuned, in one place.

A `Rules` is passed down from the diagnosis to whatever asks for one of its numbers; nothing reads
it from anywhere else. What is no rule stays where it is used and says what it is: tolerances and
limits of iterations, constants of physics and of statistics, and what one kind of sensor
is like (`naming.channels.senses`). Motion and the senses go by the same rules.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple

from realitygap.embedded_sim.errors import InputError, quoted

CHOSEN = "our choice"
"""Origin of a number of which no measurement is kept."""
DEVIANCE, SHARE = "deviance", "share"
"""Units: -2 log likelihood; a part of what the reason names."""


def _rule(default: float, unit: str, reason: str, origin: str, *, some: bool = False) -> Any:
    """A number with what is to be said of it; with `some` it cannot be 0."""
    about = {"unit": unit, "reason": reason, "origin": origin, "some": some}
    return field(default=default, metadata=about)


@dataclass(frozen=True, kw_only=True)
class Rules:
    """What naming was tuned to; units are those of `listed`.

    Raises:
        InputError: a number is negative, not finite, 0 where it may not be, or to be whole and is
            not.
    """

    # how a log is cut into windows
    window: float = _rule(
        1.0,
        "s",
        "longest window: shows 0.1 % of a speed through half a millimetre of noise, and what the "
        "model leaves out stays below that noise",
        CHOSEN,
        some=True,
    )
    most_windows: int = _rule(
        600,
        "windows",
        "used of one robot: more sharpen nothing that differences between robots leave visible",
        CHOSEN,
        some=True,
    )
    all_windows: int = _rule(
        3000,
        "windows",
        "used of a swarm: five minutes of ten robots; bounds what a long log costs",
        CHOSEN,
        some=True,
    )
    few_windows: int = _rule(
        150, "windows", "that each robot keeps, however large its swarm", CHOSEN, some=True
    )
    # the noise of windows
    row_freedom: float = _rule(
        5.0,
        "degrees",
        "of freedom of a row's Student-t errors: 1 to 4 % of a real tracker's poses are wild",
        CHOSEN,
        some=True,
    )
    window_freedom: float = _rule(
        3.0,
        "degrees",
        "of freedom of what a window has of its own, with longer tails: a push, a bump",
        CHOSEN,
        some=True,
    )
    least_scale: float = _rule(
        0.3,
        "of the tracker's noise",
        "least that rows' errors are taken to have",
        CHOSEN,
        some=True,
    )
    # what may follow a quantity
    near: float = _rule(0.1, "m", "scale on which nearness to walls and robots counts", CHOSEN)
    recent: float = _rule(0.2, "s", "scale on which a change of command is recent", CHOSEN)
    started: float = _rule(
        1.0,
        "s",
        "scale on which a start from rest is recent: small robots' motors need less to reach a "
        "speed",
        CHOSEN,
        some=True,
    )
    # what healthy robots are like
    uncorrelated: float = _rule(
        10.0,
        "robots",
        "weight of no correlation between causes, beside what was measured",
        CHOSEN,
        some=True,
    )
    believed: int = _rule(
        3,
        "robots, swarms",
        "weight of what is believed beforehand: robots differ by the error with which one log "
        "tells a coefficient, swarms by `alike` of that variance",
        CHOSEN,
        some=True,
    )
    alike: float = _rule(
        0.1,
        "of variance",
        "between swarms, of that between robots: one make and one tracker differ less from lot to "
        "lot than one by one",
        CHOSEN,
    )
    few_sure: float = _rule(
        5.0,
        "s.d.",
        "at which the spread of few robots is made as rarely passed as that of many",
        CHOSEN,
        some=True,
    )
    cause_gate: float = _rule(
        30.0,
        DEVIANCE,
        "beyond health for a name: 5.5 standard deviations. A reference whose healthy robots go "
        "farther has a higher gate",
        "our choice; the farthest of 400 healthy robots stays below it by `gate_margin` "
        "(`reference --runs 40 --seed 11`)",
    )
    flexible_gate: float = _rule(
        40.0,
        DEVIANCE,
        "the same of what follows a quantity: 6.3 standard deviations, for nothing physical bounds "
        "these terms and their tails are not normal",
        "our choice; as of `cause_gate`",
    )
    error_gate: float = _rule(
        5.0,
        "times",
        "the median error that tracker noise leaves, from which on a prediction is far off; a "
        "reference whose healthy robots drift has a higher gate",
        CHOSEN,
    )
    gate_margin: float = _rule(
        1.5, "times", "the farthest healthy robot's, where that is more than a gate", CHOSEN
    )
    # how a log was recorded, where otherwise than those of the reference
    record_rate: float = _rule(
        1e-3,
        "s per s",
        "standard deviation of how much faster one of two clocks runs: five times a bad quartz",
        CHOSEN,
    )
    record_rate_most: float = _rule(
        2e-3, "s per s", "most of the same: ten times", CHOSEN, some=True
    )
    record_scale: float = _rule(
        0.01, SHARE, "standard deviation of a tracker's metre from everybody's", CHOSEN
    )
    record_scale_most: float = _rule(
        0.03,
        SHARE,
        "most of the same: a tracker whose wand was measured with a ruler",
        CHOSEN,
        some=True,
    )
    record_rows: float = _rule(
        3.0, "rows", "most over which commands or poses are averaged", CHOSEN, some=True
    )
    record_dose: float = _rule(
        0.3,
        "of a dose",
        "or of the logarithm of a factor, standard deviation by which smeared commands make all "
        "robots' transients look other than they are: beyond what half a row does to them",
        CHOSEN,
    )
    # the search
    most_items: int = _rule(
        4,
        "items",
        "kept of one robot or swarm: more are not told apart in two minutes",
        CHOSEN,
        some=True,
    )
    least_swarm: int = _rule(
        3, "robots", "that make a swarm", "derived: of two, neither says which one differs"
    )
    deviants: float = _rule(0.2, "of the robots", "that a shared item may leave worse off", CHOSEN)
    contenders: int = _rule(5, "causes", "fitted in earnest for one place", CHOSEN, some=True)
    worth: float = _rule(
        0.3, SHARE, "of the largest linear gain, that a contender must promise", CHOSEN
    )
    least_dose: float = _rule(
        0.3, "of a dose", "least that is tried: a small share of a limit is no such cause", CHOSEN
    )
    price: float = _rule(
        4.0,
        DEVIANCE,
        "that each further parameter must take off",
        "derived: twice what one without a meaning does",
    )
    better: float = _rule(
        12.0,
        DEVIANCE,
        "by which what follows a quantity must do better than a cause to stand in its place",
        "our choice: twice `odds`",
    )
    almost: float = _rule(
        0.06, SHARE, "of a cause's gain, by which the same: no model of a cause is exact", CHOSEN
    )
    rough: float = _rule(
        0.1, SHARE, "the same of causes of transients, which are rough models", CHOSEN
    )
    left: float = _rule(
        0.25, SHARE, "of a cause's gain, most that it may keep beside what replaces it", CHOSEN
    )
    again: int = _rule(2, "times", "that a log is searched again at most", CHOSEN)
    # the stations
    mended: float = _rule(
        0.05,
        SHARE,
        "of what was named, that what follows a quantity and a further cause of the same family "
        "must exceed: no model of a cause is exact",
        CHOSEN,
    )
    odds: float = _rule(
        6.0,
        DEVIANCE,
        "by which one explanation is told from another: rivals, twins, gaps between two commanded "
        "speeds",
        "derived: odds of 20 to 1",
        some=True,
    )
    errors: float = _rule(
        3.0,
        "s.e.",
        "over blocks, by which one explanation is told from another, and wild windows from chance",
        "our choice: 1 in 700 of a normal variable",
    )
    clearly: float = _rule(
        0.2,
        SHARE,
        "of a cause's gain that a rival may not miss, however few blocks it is lost in",
        CHOSEN,
    )
    inflation: float = _rule(
        20.0,
        "times",
        "a term's variance, at which another may stand in its place: a correlation of 0.975",
        "our choice, between 4 at most of runs of two minutes that wander and 29 of real robots' "
        "circles",
    )
    chance: float = _rule(
        1e-4,
        "probability",
        "that a true cause fails to be of one size by chance: a hundred names a day for three "
        "months",
        CHOSEN,
        some=True,
    )
    different: float = _rule(
        1.0 / 3.0,
        SHARE,
        "of a cause's size by which parts of a log must differ",
        "our choice; causes that were there differed by at most 0.15",
    )
    telling: float = _rule(
        0.05,
        SHARE,
        "of what a cause changes, that must lie in a part and outside it: elsewhere any error "
        "looks like a large multiple of it",
        CHOSEN,
    )
    beside: float = _rule(
        0.5,
        SHARE,
        "of the gain of what is unknown in a robot, that a name beside it needs: what half "
        "describes the unknown would be named, too",
        CHOSEN,
    )
    wild_far: float = _rule(
        6.0, "s.d.", "robust ones of a robot's errors, beyond which a row is wild", CHOSEN
    )
    wild_rows: float = _rule(
        0.25, "of a window's rows", "that make it wild: a tracker's jump is shorter", CHOSEN
    )
    wild_more: float = _rule(
        0.25,
        "of the windows",
        "that must be wild in a part of the log beyond those elsewhere",
        "our choice; healthy runs have none",
    )
    wild_blocks: int = _rule(
        6, "blocks", "that a part must have: fewer do not tell their own spread", CHOSEN, some=True
    )
    clocks: float = _rule(
        9.0,
        DEVIANCE,
        "by which a late tracker or late commands must explain the sensors better than the other",
        "our choice: three standard deviations",
    )
    # what may be claimed
    surely: float = _rule(
        1.645,
        "s.d.",
        "beyond a gate, at which a cause counts as seen",
        "derived: 95 % of normal values",
    )
    core_share: float = _rule(
        0.05,
        SHARE,
        "wheel scale, mismatch and separation that must show before a robot is called sound: a "
        "ruler finds as much",
        CHOSEN,
    )
    core_late: float = _rule(0.1, "s", "the same of late commands: a person sees as much", CHOSEN)
    few_seconds: float = _rule(
        30.0,
        "s",
        "of free motion under commands with which a robot can be judged at all",
        "our choice: a quarter of what the blind battery's bars are stated for",
    )
    harm_level: float = _rule(
        0.05,
        "probability",
        "that any of a cause's predictions counts as better, or as worse, by chance",
        CHOSEN,
    )
    harm_margin: float = _rule(
        0.02,
        SHARE,
        "of an error, by which it must grow to count as harm: every cause changes every "
        "prediction a little",
        CHOSEN,
    )
    least_apart: int = _rule(
        8,
        "windows",
        "that share no moment, of which the median must be far off: a push that nobody saw spoils "
        "at most two",
        CHOSEN,
    )
    # what to do next
    promising: float = _rule(
        8.0,
        "s.d.",
        "between rivals that a proposed manoeuvre must promise",
        "our choice: a deviance of ten times `odds`, for blocks differ more than noise says",
    )
    of_robots: float = _rule(
        0.25,
        SHARE,
        "standard deviation of an infrared reading of another robot: noise (0.14) and the edge of "
        "a round body",
        CHOSEN,
        some=True,
    )

    def __post_init__(self) -> None:
        """Refuse what no rule can be."""
        for one in fields(self):
            value = getattr(self, one.name)
            whole = one.type == "int"
            number = isinstance(value, int if whole else int | float)
            some = one.metadata["some"]
            if (
                isinstance(value, bool)
                or not number
                or not math.isfinite(value)
                or value < 0
                or (some and value == 0)
            ):
                expected = f"{'a whole' if whole else 'a finite'} number {'>' if some else '>='} 0"
                raise InputError(f"rules.{one.name}", quoted(value), expected)


class Listed(NamedTuple):
    """One of the numbers, and what is to be said of it."""

    name: str
    value: float
    unit: str
    reason: str
    origin: str
    """How it was set: measured on what, derived from what, or our choice."""


def listed(rules: Rules) -> Iterator[Listed]:
    """All numbers, in the order in which a log meets them."""
    for one in fields(rules):
        about = one.metadata
        value = getattr(rules, one.name)
        yield Listed(one.name, value, about["unit"], about["reason"], about["origin"])

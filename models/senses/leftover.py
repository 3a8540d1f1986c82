"""What stays unexplained in the readings: flexible terms beyond health that no name takes away."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.models.diagnosis import Unexplained
from realitygap.models.senses.problem import SWARM, Problem, Term
from realitygap.models.senses.quantities import QUANTITIES
from realitygap.models.senses.reference import UNKNOWN, SenseReference
from realitygap.models.senses.sight import Bools
from realitygap.models.senses.structure import KINDS, Follow, Structure
from realitygap.models.senses.structure_health import pool

LEAST_SWARM = 3
LEAST_GAIN = 30.0
"""Squared error, in noise, that a leftover takes off; our choice: the healthy ones of a robot and
log reach 33 among four hundred terms."""
LEAST_SHARE = 0.002
"""Of the squared error that it must be, our choice: in a whole swarm's log a fiftieth of a per cent
can be surely there, of what the captured tables get wrong, and is worth nobody's time."""
ALIKE = 5.0
"""Standard deviations within which robots share a swarm's value."""
SIMILAR = 0.7
"""Of the swarm's value that a robot may differ from it by: what a swarm shares depends on where
each robot has been."""
DEVIANTS = 0.2
"""Most of the robots that may not."""


SHOWS = {"ps": {"infrared"}, "ls": {"light"}, "both": {"infrared", "light"}}
"""Channels in which a kind of cause shows."""


CLEARLY_MORE = 1.1
"""Times what a constant takes off that something must take off to be believed instead."""
ALWAYS = "always"


class Left(NamedTuple):
    """One leftover, and the term it is."""

    said: Unexplained
    follow: Follow
    gain: float

    def concerns(self, problem: Problem, term: Term) -> bool:
        """Whether a term shows in this channel and in these robots."""
        if self.follow.channel not in SHOWS[term.cause.kind]:
            return False
        everybody = term.robot == SWARM or self.said.robots == "all"
        return everybody or problem.sight.robots[term.robot] in self.said.robots


def leftovers(problem: Problem, structure: Structure, healthy: SenseReference) -> tuple[Left, ...]:
    """The leftover of each channel that takes off most: of the swarm, and of robots beyond it."""
    result: list[Left] = []
    for channel in KINDS:
        follows = [f for f in structure.follows if f.channel == channel]
        mine = [f for f in follows if healthy.health(f.key) is not None]
        whole, alike = _swarm(problem, structure, mine, healthy)
        result += [whole] if whole is not None else []
        for robot in np.flatnonzero(~alike).tolist():
            single = _single(problem, structure, mine, healthy, robot)
            result += [single] if single is not None else []
    return tuple(result)


def _swarm(
    problem: Problem, structure: Structure, found: Sequence[Follow], healthy: SenseReference
) -> tuple[Left | None, Bools]:
    """What the whole swarm shares, and (robots,) who does."""
    nobody = np.zeros(len(problem.sight.robots), dtype=np.bool_)
    passed, sharing = [], {}
    for one in found:
        known = np.isfinite(one.size)
        if known.sum() < LEAST_SWARM:
            continue
        health = healthy.health(one.key) or UNKNOWN
        wide = np.hypot(one.error, health.sd)
        middle = float(np.median(one.size[known]))
        wide = np.maximum(ALIKE * wide, SIMILAR * abs(middle))
        alike = known & (np.abs(one.size - middle) < wide)
        if alike.sum() < max(LEAST_SWARM, (1.0 - DEVIANTS) * known.sum()):
            continue
        mean, error = pool(one.size[alike], one.error[alike])
        far = abs(mean - health.mean) / np.hypot(error, health.swarm_sd)
        if far > healthy.structure_gate(one.key, swarm=True):
            passed.append(_Passed(one, float(far), float(one.gain[alike].sum())))
            sharing[one.key] = alike
    best = _best(problem, structure, found, passed, None)
    return best, nobody if best is None else sharing[best.follow.key]


def _single(
    problem: Problem,
    structure: Structure,
    found: Sequence[Follow],
    healthy: SenseReference,
    robot: int,
) -> Left | None:
    """What one robot has."""
    passed = []
    for one in found:
        health = healthy.health(one.key) or UNKNOWN
        far = abs(one.size[robot] - health.mean) / np.hypot(one.error[robot], health.sd)
        if far > healthy.structure_gate(one.key, swarm=False):  # not where nothing is known
            passed.append(_Passed(one, float(far), float(one.gain[robot])))
    return _best(problem, structure, found, passed, robot)


class _Passed(NamedTuple):
    """A term beyond health."""

    follow: Follow
    far: float
    gain: float


def _best(
    problem: Problem,
    structure: Structure,
    found: Sequence[Follow],
    passed: Sequence[_Passed],
    robot: int | None,
) -> Left | None:
    """The quantity that takes off most, each by its most promising function.

    What follows a quantity may have a mean as well: each quantity is fitted beside a constant, and
    must take off clearly more than the constant alone.
    """
    if not passed:
        return None
    promised: dict[str, dict[str, float]] = {}
    for one in passed:
        mine = promised.setdefault(one.follow.quantity, {})
        mine[one.follow.group] = mine.get(one.follow.group, 0.0) + one.gain
    groups = [max(mine, key=lambda group: mine[group]) for mine in promised.values()]
    constant = {one.change: one for one in found if one.quantity == ALWAYS}
    constants = {one.group for one in constant.values()}
    tried = []
    for group in groups:
        parts = [one for one in found if one.group == group]
        change = parts[0].change
        strongest = max((one for one in passed if one.follow.group == group), key=lambda p: p.far)
        mean = [constant[change]] if group not in constants and change in constant else []
        gain, size = structure.taken_off([*parts, *mean], robot)
        tried.append((gain, strongest, size[: len(parts)]))
    least = max(LEAST_GAIN, LEAST_SHARE * _readings(problem, found[0].channel, robot))
    tried = [one for one in tried if one[0] > least]
    if not tried:
        return None
    plain = [one for one in tried if one[1].follow.quantity == ALWAYS]
    best = max(tried, key=lambda one: one[0])
    if plain and best[0] < CLEARLY_MORE * max(one[0] for one in plain):
        best = max(plain, key=lambda one: one[0])
    gain, strongest, size = best
    amount = float(np.sqrt((size**2).sum())) if len(size) > 1 else float(size[0])
    return _said(problem, strongest.follow, robot, strongest.far, gain, amount)


def _said(
    problem: Problem, one: Follow, robot: int | None, far: float, gain: float, size: float
) -> Left:
    """One leftover in words."""
    sight = problem.sight
    number = _readings(problem, one.channel, robot)
    robots = "all" if robot is None else (sight.robots[robot],)
    said = Unexplained(
        channel=one.channel,
        share=gain / (gain + number),
        where=_where(one, size),
        quantity=one.quantity,
        robots=robots,  # type: ignore[arg-type]
        distance=far,
    )
    return Left(said, one, gain)


def _readings(problem: Problem, channel: str, robot: int | None) -> float:
    """How many readings of a channel are judged, of one robot or of all."""
    rows = slice(0, None) if robot is None else problem.sight.rows_of(robot)
    return float(problem.use[rows, KINDS[channel]].sum())


def _where(one: Follow, size: float) -> str:
    """What reads otherwise, by how much, following what."""
    what = "" if one.channel == "infrared" else " of light"
    unit = "%" if one.change == "share" else "counts"
    amount = f"{abs(size) * (100.0 if one.change == 'share' else 1.0):.2g} {unit}{what}"
    more = f"{one.channel} sensors read {amount}"
    part = one.part.strip()
    if one.quantity == ALWAYS:
        return f"{more} too {'much' if size > 0.0 else 'little'}, {QUANTITIES[ALWAYS]}"
    if one.quantity == "sensor":
        return f"{one.channel} sensor {part} reads {amount} too {'much' if size > 0 else 'little'}"
    how = {"point": f", {part}", "time": f", a swing of {part.split(' ', 1)[-1]}" if part else ""}
    return f"{more} more or less depending on {QUANTITIES[one.quantity]}{how.get(one.quantity, '')}"

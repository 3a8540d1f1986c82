"""Whether what was named fits: what it leaves, and whether what it leaves is larger than itself.

A fault that is not in the catalogue is often mimicked by one that is. The mimic takes off a part of
the error; the rest follows some measured quantity. Where the rest is small beside what the name
takes off, it is the coarseness of a model; where it is not, it is reported beside the name; where
it is as large as what the name takes off, the name is not believed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from realitygap.models.diagnosis import Unexplained
from realitygap.models.senses.leftover import SHOWS, Left, leftovers
from realitygap.models.senses.problem import SWARM, Fit, Problem, Term
from realitygap.models.senses.reference import SenseReference
from realitygap.models.senses.select import Chosen, Found
from realitygap.models.senses.structure import KINDS, Follow, Structure

MENDED = 0.04
"""Of the named causes' gain that a leftover must exceed: no model of a cause is exact."""
DOUBTFUL = 0.5
"""Of the same, beyond which the names are not believed."""

MOST_TOGETHER = 2
"""Causes of one channel believed of the same robots. Our choice: that three things are wrong with
one lamp at once is less likely than one that has no name."""

Noisy = list[tuple[float, float, bool]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Judged:
    """What is left of the names, and what they leave."""

    found: tuple[Found, ...]
    fit: Fit
    """With the terms of these alone."""
    structure: tuple[Follow, ...]
    lefts: tuple[Left, ...]
    robots: tuple[int, ...]

    @property
    def unexplained(self) -> tuple[Unexplained, ...]:
        """As the diagnosis has it."""
        return tuple(one.said for one in self.lefts)

    def believable(self, noisy: Noisy) -> Noisy:
        """Noise of the infrared where no structure is left that would look like it."""
        doubted = [one.said.robots for one in self.lefts if one.follow.channel == "infrared"]
        return [
            (0.0, error, False)
            if any(robots == "all" or robot in robots for robots in doubted)
            else (scale, error, swarm)
            for robot, (scale, error, swarm) in zip(self.robots, noisy, strict=True)
        ]


def judge(problem: Problem, chosen: Chosen, healthy: SenseReference) -> Judged:
    """Look at what the named terms leave, and take back the names that do not fit."""
    believed, fit, looked = _not_too_many(chosen.found), chosen.fit, chosen.structure
    while True:
        fit = _with_only(problem, fit, tuple(one.term for one in believed))
        structure = looked if looked and fit is chosen.fit else Structure(problem, fit)
        lefts = tuple(
            left
            for left in leftovers(problem, structure, healthy)
            if left.gain > MENDED * _explained(problem, left, believed)
        )
        doubted = [
            one
            for one in believed
            for left in lefts
            if left.concerns(problem, one.term)
            and left.gain > DOUBTFUL * _explained(problem, left, believed)
        ]
        if not doubted:
            return Judged(
                found=believed,
                fit=fit,
                structure=tuple(structure.follows),
                lefts=(*lefts, *_of_pairs(problem, fit, believed, healthy)),
                robots=problem.sight.robots,
            )
        believed = tuple(one for one in believed if one not in doubted)


def _not_too_many(found: Sequence[Found]) -> tuple[Found, ...]:
    """Without the causes of a channel and of robots that would have to have many at once."""
    kept = tuple(found)
    for channel in KINDS:
        mine = [one for one in found if channel in SHOWS[one.term.cause.kind]]
        for scope in {one.term.robot for one in mine}:
            together = [one for one in mine if one.term.robot in (scope, SWARM)]
            if len(together) > MOST_TOGETHER:
                kept = tuple(one for one in kept if one not in together)
    return kept


def _of_pairs(
    problem: Problem, fit: Fit, believed: Sequence[Found], healthy: SenseReference
) -> tuple[Left, ...]:
    """What two causes of the place together account for, as a single one without a name would."""
    paired = [one.term for one in believed if one.term.cause.place]
    if len(paired) < 2:
        return ()
    less = _with_only(problem, fit, tuple(t for t in fit.terms if t not in paired))
    names = " and ".join(term.cause.name for term in paired)
    channels = set().union(*(SHOWS[term.cause.kind] for term in paired))
    return tuple(
        left._replace(said=replace(left.said, where=f"{left.said.where}, unless it is {names}"))
        for left in leftovers(problem, Structure(problem, less), healthy)
        if left.said.robots == "all" and left.follow.channel in channels
    )


def _with_only(problem: Problem, fit: Fit, terms: tuple[Term, ...]) -> Fit:
    """The fit without the terms that nobody names."""
    if terms == fit.terms:
        return fit
    kept = [fit.coordinates[fit.part(t)] for t in fit.terms if t in terms]
    ordered = tuple(t for t in fit.terms if t in terms)
    start = np.concatenate(kept) if kept else np.zeros(0)
    return problem.fit(ordered, start)


def _explained(problem: Problem, left: Left, believed: Sequence[Found]) -> float:
    """What the names take off in a leftover's channel and robots."""
    total = 0.0
    for one in believed:
        if left.concerns(problem, one.term):
            spread = one.term.robot == SWARM and left.said.robots != "all"
            total += one.gain / (len(problem.sight.robots) if spread else 1)
    return total

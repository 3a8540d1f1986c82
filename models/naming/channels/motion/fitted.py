"""The fit that names were taken from, kept so that their values can be found again in a part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.engine.hypothesis import Fit, Term, Terms
from realitygap.models.naming.engine.threshold import bracket
from realitygap.models.naming.engine.value import Value, told, values

Robots = tuple[int, ...]
Key = tuple[Term, Robots]
"""Of a name: the term that stood for it in the search, and the ids of its robots."""
Values = Mapping[Key, tuple[Value, ...]]


class ToldValue(NamedTuple):
    """How one name's values follow from a fit."""

    searched: Term
    """That stood for it in the search."""
    term: Term
    """As it is named: the same, or its twin."""
    mean: FloatArray
    """(p,) healthy coordinates."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Fitted:
    """One group of robots with everything fitted to them."""

    problem: Problem
    """Of one group."""
    fit: Fit
    told: tuple[ToldValue, ...]
    believed: Terms
    """Of the fit, but for mimics."""

    @property
    def motions(self) -> list[Motion]:
        """(robots,) motion with the terms that are believed."""
        return _motions(self.problem, self.fit, self.believed)


def _values(problem: Problem, fit: Fit, one: ToldValue) -> tuple[Value, ...]:
    at, term = fit.part(one.term), one.term
    if not term.cause.smooth:
        parameter = term.cause.parameters[0]

        def deviance(threshold: float) -> float:
            here = fit.coordinates.copy()
            here[0, at.start] = threshold
            return float(problem.losses(problem.residual(fit.terms, here)).sum())

        here = float(fit.coordinates[0, at.start])
        found = bracket(problem.tracks.commands, here, deviance, problem.tracks.rules.odds)
        return (told(parameter, found.mean, found.low, found.high),)
    return values(
        term,
        fit.coordinates[0, at] - one.mean,
        fit.covariance[0, at, at],
    )


def _motions(problem: Problem, fit: Fit, believed: Terms) -> list[Motion]:
    columns = [np.r_[fit.part(term)] for term in believed]
    kept = fit.coordinates[:, np.concatenate([np.r_[0:0], *columns])]
    return problem.motions(believed, kept)


def refitted(fits: Sequence[Fitted], part: int) -> Values:
    """The values that one part of the log gives by itself, each fit begun at the whole log's.

    What a swarm shares comes first; what single robots have is fitted beyond it. A name whose
    robots have no window in the part is absent.
    """
    found: dict[Key, tuple[Value, ...]] = {}
    shared: dict[int, Motion] = {}
    for one in fits:
        tracks = one.problem.tracks.of_part(part)
        if not len(tracks.first):
            continue
        robots = tracks.robots
        base = [shared.get(r, m) for r, m in zip(robots, one.problem.base, strict=True)]
        problem = Problem(tracks, base, groups=one.problem.groups, scale=one.problem.scale.copy())
        try:
            fit = problem.fit(one.fit.terms, [one.fit.coordinates])
        except Diverged:
            continue
        if len(robots) > 1:
            shared.update(zip(robots, _motions(problem, fit, one.believed), strict=True))
        for each in one.told:
            found[each.searched, robots] = _values(problem, fit, each)
    return found

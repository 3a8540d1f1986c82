"""What a cause whose term is rough makes a robot seem to have of other causes.

Wheels that slip are no exact limit of acceleration, nor is a weak motor: what the term leaves is
fitted best by a little latency, lag or another axle, which nobody has. How much, is measured once
(`Cause.feigns`) and counts as uncertainty of the weaker cause.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from models.causes import Cause
from models.identify.choice import Choice, Evidence, Mimic
from models.identify.fit import Problem
from models.identify.hypothesis import Term
from models.identify.measure import distance
from models.identify.twins import Twins
from models.reference import Reference


def feigned(of: Twins, by: Sequence[Twins]) -> float:
    """Standard deviation of a cause's coordinate that others feign together."""
    each = [
        max(one.feigns.get(other.name, 0.0) for one in _causes(rough) for other in _causes(of))
        for rough in by
    ]
    return float(np.hypot.reduce(each, initial=0.0))


def believable(
    problem: Problem,
    choice: Choice,
    twins: Mapping[Term, Twins],
    reference: Reference,
) -> tuple[tuple[Evidence, ...], tuple[Mimic, ...]]:
    """The choice's evidence and mimics that are beyond health whatever stronger causes feign.

    Args:
        problem: Of the choice.
        choice: What was selected.
        twins: Of every term named in it.
        reference: Whose gates say how far health reaches.
    """

    def stands(one: Evidence) -> bool:
        of = twins.get(one.term, Twins(one.term, choice.fit, ()))
        extra = feigned(of, [twins[o.term] for o in choice.named if o.gain > one.gain])
        sure = extra == 0.0 or not one.term.cause.smooth
        return sure or _far(problem, one, extra, reference)

    named = tuple(one for one in choice.named if stands(one))
    return named, tuple(mimic for mimic in choice.mimics if stands(mimic.evidence))


def _far(problem: Problem, one: Evidence, extra: float, reference: Reference) -> bool:
    """Whether a cause's distance from health passes its gate with so much more uncertainty."""
    swarm = len(problem.tracks.robots) > 1
    mean, sd = reference.spread(one.term.key, len(one.coordinates), swarm=swarm)
    away = distance(
        one.term,
        one.coordinates[None],
        one.covariance[None],
        problem.tracks.commands,
        mean,
        np.hypot(sd, extra),
        np.zeros(1),
    )
    return float(away[0]) >= reference.gate(one.term.key, swarm=swarm)


def _causes(twins: Twins) -> tuple[Cause, ...]:
    return (twins.chosen.cause, *(other.cause for other in twins.others))

"""What makes a robot seem to have causes that it does not have.

A cause whose term is rough: wheels that slip are no exact limit of acceleration, nor is a weak
motor; what the term leaves is fitted best by a little latency, lag or another axle. How much, is
measured once (`Cause.feigns`): a weaker cause must stand out from it, and intervals hold it.

And health: sound robots differ in everything a little. Where a robot's motion hardly tells two
causes apart, as a turned marker from a displaced one in circles, a little of the one looks like
much of the other. How much, follows from the log and the healthy spread of all causes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Cause
from realitygap.models.identify.candidates import candidates
from realitygap.models.identify.choice import Choice, Evidence, Mimic
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term
from realitygap.models.identify.measure import distance
from realitygap.models.identify.residual import weights
from realitygap.models.identify.twins import Twins
from realitygap.models.information import inverted
from realitygap.models.reference import Reference


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
    if not choice.named and not choice.mimics:
        return (), ()
    healthy = _of_health(problem, choice.fit, reference)

    def stands(one: Evidence) -> bool:
        if not _linear(one.term):
            return True
        of = twins.get(one.term, Twins(one.term, choice.fit, ()))
        extra = feigned(of, [twins[o.term] for o in choice.named if o.gain > one.gain])
        return _far(problem, one, np.hypot(healthy[choice.fit.part(one.term)], extra), reference)

    named = tuple(one for one in choice.named if stands(one))
    return named, tuple(mimic for mimic in choice.mimics if stands(mimic.evidence))


def _linear(term: Term) -> bool:
    """Whether small values of a cause make small changes."""
    return term.cause.smooth and all(np.isfinite(p.null) for p in term.cause.parameters)


def _of_health(problem: Problem, kept: Fit, reference: Reference) -> FloatArray:
    """(p,) standard deviations of a fit's coordinates that healthy differences in everything that
    is not in it would feign."""
    swarm = len(problem.tracks.robots) > 1
    names = {term.cause.name for term in kept.terms}
    changes = []
    for other in candidates():
        if other.cause.name in names or not _linear(other) or not reference.knows(other.key):
            continue
        terms = (*kept.terms, other)
        size = len(other.cause.parameters)
        here = np.hstack([kept.coordinates, np.zeros((1, size))])
        column = problem.jacobian(terms, here, kept.residual, kept.coordinates.shape[1])
        _, sd = reference.spread(other.key, size, swarm=swarm)
        changes.append(column * np.hypot(sd, [p.elsewhere for p in other.cause.parameters]))
    if not changes:
        return np.zeros(kept.coordinates.shape[1])
    own = problem.jacobian(kept.terms, kept.coordinates, kept.residual)
    pulled = own * weights(kept.residual, problem.row_scale)[:, :, None]
    inverse = inverted(np.einsum("ncp,ncq->pq", pulled, own)).matrix
    slope = np.einsum("ncp,ncq->pq", pulled, np.dstack(changes))
    return np.asarray(np.sqrt(((inverse @ slope) ** 2).sum(axis=1)))


def _far(problem: Problem, one: Evidence, extra: FloatArray, reference: Reference) -> bool:
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

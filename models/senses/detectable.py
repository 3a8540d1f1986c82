"""What a log's readings would have shown: per fitted cause, the size from which it is seen.

As for motion (`models.identify.detectable`): so far from health that the gate is passed with 95 %
probability, by the error that one linear step gives over blocks, and the healthy spread. Dead
sensors, noise and the nest are judged otherwise and are not among them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.withheld import withheld
from realitygap.models.diagnosis import Detectable
from realitygap.models.identify.detectable import rare
from realitygap.models.rules import Rules
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.glance import FITTED, NO_COMMANDS, Promise
from realitygap.models.senses.problem import SWARM, Fit, Term
from realitygap.models.senses.reference import SenseReference
from realitygap.models.senses.sight import Sight

SURELY = Rules().surely
"""As shipped: the old selection of the senses goes by no other rules."""


def detectable_in(
    promises: Sequence[Promise], fit: Fit, sight: Sight, healthy: SenseReference
) -> tuple[Detectable, ...]:
    """Every cause that is fitted to readings, by name; of single sensors the worst.

    Args:
        promises: Of every term beside what is fitted.
        fit: With what is.
        sight: Of the log.
        healthy: Whose gates and spread count.
    """
    blocks = [len(np.unique(sight.block[sight.rows_of(k)])) for k in range(len(sight.robots))]
    number = {SWARM: sum(blocks), **dict(enumerate(blocks))}
    sizes: dict[tuple[str, str, int], float] = {}
    fitted = [(t, np.sqrt(np.diag(fit.covariance)[fit.part(t)])) for t in fit.terms]
    for term, error in [*((one.term, one.error) for one in promises), *fitted]:
        cause, variant, robot = term
        sizes[cause.name, variant, robot] = _size(term, error, number[robot], healthy)
    return tuple(
        _worst(name, sizes, sight.robots)
        for name, cause in sense_causes().items()
        if cause.kind in FITTED and not withheld(name)
    )


def _size(term: Term, errors: FloatArray, blocks: int, healthy: SenseReference) -> float:
    """Departure of a term's worst parameter from its null; NaN: more than is possible."""
    swarm = term.robot == SWARM
    gain, gate = healthy.gates(term.key, swarm=swarm)
    _, sd = healthy.spread(term.key, term.size, swarm=swarm)
    found = []
    for p, error, wide in zip(term.cause.parameters, errors, sd, strict=True):
        if error > 0.0:  # where the last number is a strength, the others only say of what
            far = np.hypot(rare(gate, blocks) * error, gate * np.hypot(wide, p.elsewhere))
            size = max(float(far), np.sqrt(gain) * float(error)) + SURELY * float(error)
            inside = blocks > 1 and size <= p.bounds[1]
            found.append(abs(p.value(size) - p.null) if inside else np.nan)
    return float(np.max(found)) if found else np.nan


def _worst(
    name: str, sizes: dict[tuple[str, str, int], float], robots: tuple[int, ...]
) -> Detectable:
    """Over robots and sensors; a single robot, and the place, are judged as the swarm."""
    cause = sense_causes()[name]
    whole = cause.place or len(robots) == 1
    scopes = (SWARM,) if whole else tuple(range(len(robots)))
    found = {(s, v): sizes.get((name, v, s), np.nan) for s in scopes for v in cause.variants}
    worst = max(found, key=lambda at: np.inf if np.isnan(found[at]) else found[at])
    parameter = cause.parameters[-1 if cause.starts(NO_COMMANDS) else 0]
    return Detectable(
        cause=name,
        parameter=parameter.name,
        unit=parameter.unit,
        null=parameter.null,
        size=None if np.isnan(found[worst]) else found[worst],
        robot=None if cause.place else robots[max(worst[0], 0)],
    )

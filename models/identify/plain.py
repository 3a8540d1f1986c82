"""Whether something plain does better than a cause: a measured quantity that the motion follows.

A cause named in a robot must tell more than one channel that follows any one quantity in its place.
What loses speed in step with speed itself is half described by a limit; the quantity tells it all.
"""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.choice import Replaced
from realitygap.models.identify.consistency import solved
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit
from realitygap.models.identify.residual import weights
from realitygap.models.identify.structure import columns

PRICE = 4.0
"""Deviance that each flexible term must take off: twice what one without a meaning does."""
MARGIN = 12.0
"""Deviance by which a quantity must do better; the least that any term must gain."""
LEFT = 0.25
"""Of a cause's gain, most that it may still take off beside the quantity: what has nothing to do
with the cause, as what every robot of a kind shows, leaves it all of its gain. Our choice."""
STEPS = 3
"""Of a robust fit of linear terms."""


def replaced(problem: Problem, kept: Fit, without: Fit, gain: float) -> Replaced | None:
    """The quantity that does better than a cause and leaves it little, other causes giving way.

    Args:
        problem: Of one robot.
        kept: All terms, fitted.
        without: All terms but the cause, fitted.
        gain: Held-out deviance that the cause takes off.
    """
    motions = problem.motions(without.terms, without.coordinates)
    others = problem.jacobian(without.terms, without.coordinates, without.residual)
    cause = (kept.residual - without.residual)[:, :, None]
    own = _taken_off(problem, without, np.dstack([cause, others]))
    best, most = None, max(gain, own) + MARGIN
    for (quantity, channel), flexible in columns(problem.tracks, motions).items():
        beside = np.dstack([*flexible, others])
        taken = _taken_off(problem, without, beside)
        if taken - PRICE * len(flexible) < most:
            continue
        more = _taken_off(problem, without, np.dstack([beside, cause]))
        if more - taken < LEFT * gain:
            best, most = Replaced(channel, quantity), taken - PRICE * len(flexible)
    return best


def _taken_off(problem: Problem, fit: Fit, changes: FloatArray) -> float:
    """Deviance that linear terms take off a fit's errors."""
    left = fit.residual
    for _ in range(STEPS):
        step, _ = solved(problem, changes, left, weights(left, problem.row_scale))
        left = left + changes @ step
    return float((problem.losses(fit.residual) - problem.losses(left)).sum())

"""Which names may stand beside something unexplained.

No cause describes what is unknown, and the best of those that half describe it would be named. A
name stands if it is not much weaker than the unknown, and keeps its strength when the robot is
allowed whatever the unknown was found to follow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.models.diagnosis import Unexplained
from realitygap.models.identify.consistency import leave_one, solved
from realitygap.models.identify.residual import weights
from realitygap.models.identify.select import BESIDE
from realitygap.models.identify.structure import QUANTITIES, Follow, columns
from realitygap.models.identify.swarm import Identified, Named
from realitygap.models.identify.tracks import Tracks
from realitygap.models.reference import Reference

KEPT = 0.5
"""Of a cause's strength that must be left. Our choice."""


def standing(
    tracks: Tracks,
    found: Identified,
    structure: list[Follow],
    left: Sequence[Unexplained],
    reference: Reference,
) -> Identified:
    """What was found, without the names that do not stand beside what is unexplained.

    Args:
        tracks: The log's.
        found: What was named.
        structure: Flexible terms beyond everything kept.
        left: What stays unexplained.
        reference: Whose gates say how sure a name must be.
    """
    if not left and not found.mimics:
        return found
    unknown = np.zeros(len(tracks.robots))
    for one in left:
        gains = [follow.gain for follow in structure if follow.quantity == one.quantity]
        most = np.max(gains, axis=0, initial=0.0)
        unknown = np.where(_has(one, tracks), np.maximum(unknown, most), unknown)
    for k, mimics in found.mimics.items():
        unknown[k] = max(unknown[k], *(mimic.gain for mimic in mimics))
    kept = [
        one
        for one in found.named
        if one.evidence.gain > BESIDE * unknown[np.isin(tracks.robots, one.robots)].sum()
        and all(
            _lasting(found, tracks, one, quantity, reference.gates.distance)
            for quantity in _beside(one, left)
        )
    ]
    return replace(found, named=tuple(kept))


def _has(one: Unexplained, tracks: Tracks) -> np.ndarray:
    """(robots,) who has something unexplained."""
    return np.isin(tracks.robots, tracks.robots if one.robots == "all" else one.robots)


def _beside(named: Named, left: Sequence[Unexplained]) -> set[str]:
    """Quantities that something unexplained in a named cause's robots follows."""
    return {
        one.quantity
        for one in left
        if one.quantity in QUANTITIES
        and (one.robots == "all" or set(one.robots) & set(named.robots))
    }


def _lasting(
    found: Identified, tracks: Tracks, named: Named, quantity: str, distance: float
) -> bool:
    """Whether a cause keeps its strength beside flexible terms of a quantity."""
    shared = found.shared is not None and len(named.robots) > 1
    choice = found.shared if shared else found.choices[tracks.robots.index(named.robots[0])]
    assert choice is not None
    problem, kept = choice.problem, choice.fit
    change, others = leave_one(problem, kept, named.evidence.term)
    motions = problem.motions(kept.terms, kept.coordinates)
    by_channel = columns(problem.tracks, motions, (quantity,))
    flexible = [column for channel in by_channel.values() for column in channel]
    every = np.dstack([change, others, *flexible])
    step, covariance = solved(
        problem, every, kept.residual, weights(kept.residual, problem.row_scale)
    )
    strength, error = 1.0 + float(step[0]), float(np.sqrt(covariance[0, 0]))
    return strength > max(KEPT, distance * error)

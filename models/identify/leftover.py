"""What stays unexplained: flexible terms beyond health that no named cause has taken away."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.diagnosis import Unexplained
from realitygap.models.identify.choice import Evidence, Replaced
from realitygap.models.identify.consistency import PARTS, Misfit
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.structure import CHANNELS, QUANTITIES, Follow, pool
from realitygap.models.identify.swarm import Identified
from realitygap.models.identify.tracks import Tracks
from realitygap.models.identify.wild import Wild, wild
from realitygap.models.reference import UNKNOWN, Reference

MENDED = 0.05
"""Of the named causes' gain that a leftover must exceed: no model of a cause is exact."""
LEAST_SWARM = 3
"""Robots that make a swarm."""


def leftover(
    tracks: Tracks, found: list[Follow], identified: Identified, reference: Reference
) -> tuple[Unexplained, ...]:
    """The most conspicuous leftover of the swarm, or of each robot, or else what mimics a cause.

    Args:
        tracks: The log's.
        found: Flexible terms beyond everything kept.
        identified: What was named.
        reference: What healthy robots show.
    """
    usable = [one for one in found if reference.health(one.key) is not None]
    named = np.zeros(len(tracks.robots))
    for one in identified.named:
        share = one.evidence.gain / len(one.robots)
        named += np.isin(tracks.robots, one.robots) * share
    whole = _swarm(tracks, usable, reference, named)
    if whole is not None:
        return (whole,)
    result = []
    for k in np.unique(tracks.robot).tolist():  # the others were never free
        robot = tracks.robots[k]
        aside = wild(Problem(tracks.only([k]), [identified.explained[k]]))
        if aside is not None:
            result.append(_set_aside(aside, robot))
            continue
        best, far = _strangest(usable, k, float(named[k]), reference)
        mimics = identified.mimics.get(k, ())
        worst = max(mimics, key=lambda mimic: mimic.gain, default=None)
        if worst is not None and isinstance(worst.misfit, Replaced):
            result.append(_replaced(worst.evidence, worst.misfit, robot))
        elif best is not None:
            result.append(_said(best, (robot,), far, float(best.gain[k]), tracks))
        elif worst is not None and isinstance(worst.misfit, Misfit):
            result.append(_mimicked(worst.evidence, worst.misfit, robot))
    return tuple(result)


def _strangest(
    found: list[Follow], k: int, named: float, reference: Reference
) -> tuple[Follow | None, float]:
    """The term of one robot that is farthest beyond its gate, and its distance from health."""
    best, most, distance = None, 1.0, 0.0
    for one in found:
        far = float(_distance(one, reference)[k])
        gain = float(one.gain[k])
        enough = gain > MENDED * named and gain > reference.gates.gain
        if enough and far / _gate(one, reference) > most:
            best, most, distance = one, far / _gate(one, reference), far
    return best, distance


def _set_aside(found: Wild, robot: int) -> Unexplained:
    """What no fit comes near, in words."""
    return Unexplained(
        channel="speed",
        share=found.share,
        where=f"it moves quite unlike the model {PARTS[found.part]}, in "
        f"{100 * found.inside:.0f} % of these windows ({100 * found.outside:.0f} % elsewhere)",
        quantity=found.part,
        robots=(robot,),
        distance=found.more / max(found.error, 1e-3),
    )


def _replaced(evidence: Evidence, better: Replaced, robot: int) -> Unexplained:
    """What a quantity tells better than a cause."""
    return Unexplained(
        channel=better.channel,
        share=evidence.share,
        where=f"{CHANNELS[better.channel]} depending on {QUANTITIES[better.quantity]}",
        quantity=better.quantity,
        robots=(robot,),
        distance=evidence.distance,
    )


def _mimicked(evidence: Evidence, found: Misfit, robot: int) -> Unexplained:
    """What half looks like a cause, where no measured quantity says it better."""
    return Unexplained(
        channel=found.channel,
        share=evidence.share,
        where=f"{CHANNELS[found.channel]} {PARTS[found.part]}: "
        f"as with {evidence.term.cause.name}, but {found.inside:.2g} times as much there and "
        f"{found.outside:.2g} times elsewhere",
        quantity=found.part,
        robots=(robot,),
        distance=abs(found.inside - found.outside) / found.error,
    )


def _swarm(
    tracks: Tracks, found: list[Follow], reference: Reference, named: FloatArray
) -> Unexplained | None:
    """What the whole swarm shares: the pooled size lies beyond what healthy swarms show."""
    if len(tracks.robots) < LEAST_SWARM:
        return None
    best, most = None, 1.0
    for one in found:
        health = reference.health(one.key) or UNKNOWN
        mean, error = pool(one.size, one.error)
        far = abs(mean - health.mean) / np.hypot(error, health.swarm_sd)
        alike = np.abs(one.size - mean) < 5.0 * np.hypot(one.error, health.sd)
        beyond = one.gain.sum() > MENDED * named.sum()
        gate = max(reference.gates.structure, reference.gates.margin * health.swarm_farthest)
        if alike.all() and beyond and far / gate > most:
            best, most = (one, float(far)), far / gate
    if best is None:
        return None
    one, far = best
    return _said(one, "all", far, float(one.gain.sum()), tracks)


def _distance(one: Follow, reference: Reference) -> FloatArray:
    """(robots,) standard deviations from health."""
    health = reference.health(one.key) or UNKNOWN
    return np.asarray(np.abs(one.size - health.mean) / np.hypot(one.error, health.sd))


def _gate(one: Follow, reference: Reference) -> float:
    health = reference.health(one.key) or UNKNOWN
    return max(reference.gates.structure, reference.gates.margin * health.farthest)


def _said(
    one: Follow, robots: tuple[int, ...] | str, far: float, gain: float, tracks: Tracks
) -> Unexplained:
    """One leftover in words."""
    rows = (
        len(tracks.rows)
        if robots == "all"
        else len(tracks.only([tracks.robots.index(r) for r in robots]).rows)
    )
    return Unexplained(
        channel=one.channel,
        share=float(gain / (gain + 3.0 * rows)),
        where=f"{CHANNELS[one.channel]} depending on {QUANTITIES[one.quantity]}",
        quantity=one.quantity,
        robots="all" if robots == "all" else tuple(robots),  # type: ignore[arg-type]
        distance=float(far),
    )

"""What this very log would have shown: per cause and robot, the size from which it is seen.

A cause of a size is counted as seen if with 95 % probability it passes both gates that a name
needs. *Distance*: it lies so many standard deviations from health, by the fit's error over blocks
and the healthy spread, of this cause and of whatever else looks like it in this log. Few blocks
give uncertain errors, so that the gate becomes the quantile of Student's t with the same tail; one
block tells nothing. *Gain*: it takes off so much deviance. Sizes are those of one cause alone. Of
causes whose effect grows otherwise than in proportion (limits, dead zones) the sizes tried are
those from which fits start.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, stdtrit

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Cause, Motion, causes
from realitygap.models.causes.withheld import withheld
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Term
from realitygap.models.identify.measure import strength
from realitygap.models.identify.screen import Glance, Look, looks
from realitygap.models.identify.tracks import Tracks
from realitygap.models.reference import Reference

SURELY = 1.645
"""Standard deviations beyond a gate at which 95 % of normal values pass it."""
CORE = {
    "wheel_radius_scale": 0.05,
    "wheel_radius_mismatch": 0.05,
    "wheel_separation": 0.05,
    "command_latency": 0.1,
}
"""Sizes (1, 1, 1, s) of the causes that every robot on two wheels can have, from which they must
show before a robot is called sound: an error of a twentieth is what a ruler finds, and a tenth of
a second what a person sees. Our choice."""


class Seen(NamedTuple):
    """From which size on one cause would have been seen."""

    cause: Cause
    size: FloatArray
    """(robots,) departure of its first parameter from the null, in its unit; of a limit (infinite
    null) its value, below which it is seen. NaN where it could not have been seen."""


def detectable(tracks: Tracks, motions: Sequence[Motion], reference: Reference) -> list[Seen]:
    """Every cause of motion that can be named, by name.

    Args:
        tracks: The log's.
        motions: (robots,) what each is believed to do; a cause is looked for beyond it.
        reference: Whose gates and healthy spread count.
    """
    blocks = _blocks(tracks)
    by_term: dict[Term, list[Glance]] = {}
    steps: list[Look] = []
    for one in looks(Problem(tracks, motions)):
        by_term.setdefault(one.glance.term, []).append(one.glance)
        if _linear(one.glance.term) and _is_step(one.glance):
            steps.append(one)
    feigned = _feigned(steps, tracks, reference)
    by_name: dict[str, list[FloatArray]] = {}
    for term, probes in by_term.items():
        extra = feigned.get(term, np.zeros((len(term.cause.parameters), len(tracks.robots))))
        found = _coordinates(term, probes, extra, blocks, tracks, reference)
        by_name.setdefault(term.cause.name, []).append(found)
    seen = []
    for name, cause in causes().items():
        if not cause.identifiable or withheld(name):
            continue
        own = by_name.get(name)
        stands = next((t for t in cause.twins if t in by_name), None)
        if own is not None:
            sizes = [_worst(cause, found) for found in own]
            size = (
                np.max(sizes, axis=0)
                if np.isfinite(cause.parameters[0].null)
                else np.min(sizes, axis=0)
            )
        elif stands is not None:
            size = _of_twin(cause, causes()[stands], by_name[stands][0], motions)
        else:
            size = np.full(len(tracks.robots), np.nan)
        seen.append(Seen(cause, size))
    return seen


def untold(seen: Sequence[Seen], robots: Sequence[int]) -> dict[int, tuple[str, ...]]:
    """By robot that cannot be called sound, the core causes that it could have unseen."""
    missed: dict[int, tuple[str, ...]] = {}
    for one in seen:
        if one.cause.name in CORE:
            unseen = ~(one.size <= CORE[one.cause.name])
            for k in np.flatnonzero(unseen).tolist():
                missed[robots[k]] = (*missed.get(robots[k], ()), one.cause.name)
    return missed


def _blocks(tracks: Tracks) -> FloatArray:
    """(robots,) blocks of windows of each."""
    block, robot = tracks.block, tracks.robot
    each = np.unique(np.column_stack([robot, block]), axis=0)[:, 0]
    return np.bincount(each, minlength=len(tracks.robots)).astype(np.float64)


def _linear(term: Term) -> bool:
    """Whether small values of a cause make small changes."""
    return term.cause.smooth and all(np.isfinite(p.null) for p in term.cause.parameters)


def _is_step(probe: Glance) -> bool:
    """Whether a probe is a small step of one parameter."""
    k = int(np.argmax(np.abs(probe.unit)))
    return bool(abs(probe.unit[k]) <= probe.term.cause.parameters[k].step)


def _spread(term: Term, reference: Reference) -> FloatArray:
    """(p,) healthy spread of a term's coordinates, here and elsewhere."""
    _, sd = reference.spread(term.key, len(term.cause.parameters))
    return np.asarray(np.hypot(sd, [p.elsewhere for p in term.cause.parameters]))


def _feigned(steps: Sequence[Look], tracks: Tracks, reference: Reference) -> dict[Term, FloatArray]:
    """(p, robots) by term, standard deviation of what healthy differences in everything else feign
    of its coordinates in this log."""
    if not steps:
        return {}
    wide, columns = [], []
    for one in steps:
        k = int(np.argmax(np.abs(one.glance.unit)))
        spread = float(_spread(one.glance.term, reference)[k])
        wide.append(spread if np.isfinite(spread) else 0.0)  # unmeasured: nobody knows
        columns.append(np.sqrt(one.weight) * one.change / one.glance.unit[k])
    every = np.array(columns)
    names = [one.glance.term.cause.name for one in steps]
    apart = np.array([[a != b for b in names] for a in names])
    row_robot = tracks.robot[tracks.window]
    found: dict[Term, list[FloatArray]] = {}
    shares = np.zeros((len(steps), len(tracks.robots)))
    for robot in np.unique(row_robot).tolist():
        mine = every[:, row_robot == robot].reshape(len(steps), -1)
        gram = mine @ mine.T
        pull = gram / np.maximum(np.diag(gram), np.finfo(float).tiny)[:, None]
        shares[:, robot] = np.sqrt(((pull * wide) ** 2 * apart).sum(axis=1))
    for one, share in zip(steps, shares, strict=True):
        found.setdefault(one.glance.term, []).append(share)
    return {term: np.array(each) for term, each in found.items()}


def _coordinates(
    term: Term,
    probes: Sequence[Glance],
    extra: FloatArray,
    blocks: FloatArray,
    tracks: Tracks,
    reference: Reference,
) -> FloatArray:
    """(p, robots) coordinates of a term from which it is seen, or of a probe that is; else NaN."""
    size = len(term.cause.parameters)
    wide = _spread(term, reference)
    gate = reference.gate(term.key)
    linear = _linear(term)
    best = np.full((size, len(tracks.robots)), np.nan)
    if not (np.isfinite(gate) and np.isfinite(wide).all()):
        return best  # no name without health that was measured
    for probe in sorted(probes, key=lambda one: float(np.abs(one.unit).max())):
        k = int(np.argmax(np.abs(probe.unit)))
        unit = float(strength(term, probe.unit[None], tracks.commands)[0, k])
        if unit == 0.0:
            continue
        health = np.hypot(wide[k], extra[k]) / abs(unit) * term.cause.smooth
        dose, tried = _dose(probe, health, gate, blocks, reference.gates.gain), abs(probe.unit[k])
        shown = dose <= 1.0
        if not np.isfinite(term.cause.parameters[k].null):
            best[k] = np.where(shown, np.fmax(best[k], tried), best[k])
        elif not linear:  # the least from which on all are seen
            best[k] = np.where(shown, np.fmin(best[k], tried), np.nan)
        elif _is_step(probe):
            best[k] = np.fmin(best[k], dose * tried)
        else:
            best[k] = np.where(shown, np.fmin(best[k], tried), best[k])
    return best


def _dose(probe: Glance, health: float, gate: float, blocks: FloatArray, gain: float) -> FloatArray:
    """(robots,) multiples of a probe that pass both gates; infinite where none does."""
    far = np.hypot(rare(gate, blocks) * probe.error, gate * health) + SURELY * probe.error
    enough = (np.sqrt(gain) + SURELY) / np.sqrt(probe.curvature)
    return np.where(blocks > 1.0, np.maximum(far, enough), np.inf)


def rare(gate: float, blocks: npt.ArrayLike) -> FloatArray:
    """Standard errors over so many blocks that chance passes as rarely as a normal variable does a
    gate."""
    free = np.maximum(np.asarray(blocks, dtype=np.float64) - 1.0, 1.0)
    return np.asarray(-stdtrit(free, ndtr(-gate)))


def _worst(cause: Cause, coordinates: FloatArray) -> FloatArray:
    """(robots,) sizes of a cause out of (p, robots) coordinates: of its parameters the worst."""
    sizes = []
    for p, found in zip(cause.parameters, coordinates, strict=True):
        if not np.isfinite(p.null):
            sizes.append(found)
            continue
        side = -1.0 if p.sign < 0 else 1.0
        low, high = p.bounds
        possible = np.isfinite(found) & (side * found >= low) & (side * found <= high)
        value = np.array(
            [p.value(side * u) if ok else np.nan for u, ok in zip(found, possible, strict=True)]
        )
        sizes.append(np.abs(value - p.null))
    return np.asarray(np.max(sizes, axis=0))


def _of_twin(
    cause: Cause, stands: Cause, coordinates: FloatArray, motions: Sequence[Motion]
) -> FloatArray:
    """(robots,) the same of a cause for which another stood in the search."""
    if cause.as_twin is None:
        return np.full(len(motions), np.nan)
    (p,), (of,) = cause.parameters, stands.parameters
    side = -1.0 if of.sign < 0 else 1.0
    found = []
    for motion, u in zip(motions, coordinates[0], strict=True):
        value = None
        if np.isfinite(u) and of.bounds[0] <= side * u <= of.bounds[1]:
            value = cause.as_twin(motion, stands.applied(motion, np.array([side * u])))
        found.append(np.nan if value is None else abs(value - p.null))
    return np.array(found)

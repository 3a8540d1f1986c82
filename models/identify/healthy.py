"""A healthy reference from healthy logs: inherent motion, spreads of every term, gates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import ALL, Motion
from realitygap.models.identify.candidates import candidates, own_starts
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term
from realitygap.models.identify.inherent import INHERENT
from realitygap.models.identify.measure import distance, jump, strength, uncertainty
from realitygap.models.identify.structure import follows, pool
from realitygap.models.identify.tracks import Tracks
from realitygap.models.reference import Reference, Spread, Structure

STARTS = ((0.0, 0.0, -0.005, 0.009, -0.2, 0.0), (0.0, 0.0, 0.02, 0.05, -0.5, 0.0))
"""Coordinates from which the inherent motion is fitted: motors of several kinds."""
LEAST_GAIN = 12.0
"""Held-out deviance below which a distance is chance."""
SHRINK = 1.4826
OUTLYING = 5.0
"""Robust standard deviations beyond which a robot does not count: one of the robots may be ill."""


def fit_inherent(tracks: Tracks, drive: Drive) -> FloatArray:
    """(6,) coordinates of the inherent motion of one swarm, all robots together."""
    robots = len(tracks.robots)
    problem = Problem(tracks, [Motion(drive=drive)] * robots, groups=np.zeros(robots, dtype=int))
    starts = [np.array([start]) for start in STARTS]
    return np.asarray(problem.fit((Term(INHERENT, ALL),), starts).coordinates[0])


class Solo(NamedTuple):
    """One term fitted alone."""

    fit: Fit
    gain: FloatArray
    """(groups,) held-out deviance taken off."""
    jumped: FloatArray
    """(groups,) `models.identify.measure.jump`, of a term whose effect jumps."""


@dataclass(frozen=True, eq=False)
class Healthy:
    """Every term fitted to the robots of one healthy swarm, and to the swarm as a whole."""

    commands: FloatArray
    robots: dict[str, Solo]
    """By term, a group per robot."""
    swarm: dict[str, Solo]
    number: int
    structure: dict[str, FloatArray]
    """By flexible term: (robots, 2) size and its error."""


def fit_terms(tracks: Tracks, healthy: Motion) -> Healthy:
    """Fit every term alone to each robot and to all together."""
    robots = len(tracks.robots)
    parts = []
    for groups in (np.arange(robots), np.zeros(robots, dtype=np.int64)):
        problem = Problem(tracks, [healthy] * robots, groups=groups)
        none = problem.at((), np.zeros((problem.count, 0)))
        none_far = np.zeros(problem.count)
        kept = {}
        for term in candidates():
            begin = own_starts(term, tracks.commands)
            if begin:
                fit = problem.fit((term,), [np.tile(s, (problem.count, 1)) for s in begin])
                jumped = none_far if term.cause.smooth else jump(problem, none, fit)
                gain = problem.by_group(problem.gain(none, fit))
                kept[term.key] = Solo(_light(fit), gain, jumped)
        parts.append(kept)
    flexible = {
        one.key: np.column_stack([one.size, one.error])
        for one in follows(tracks, [healthy] * robots)
    }
    return Healthy(tracks.commands, parts[0], parts[1], robots, flexible)


def _light(fit: Fit) -> Fit:
    """A fit without its rows."""
    empty = np.empty((0, 3))
    return replace(fit, residual=empty, held_out=empty)


def make_reference(
    swarms: Sequence[Healthy], inherent: FloatArray, *, model: str, drive: Drive, command: str
) -> Reference:
    """Put healthy swarms together.

    Args:
        swarms: Of sound robots only.
        inherent: (6,) coordinates they were fitted beyond.
        model: The model's name.
        drive: The model's.
        command: What the user typed, for the record.
    """
    terms = {}
    for term in candidates():
        each = [(s.robots[term.key], s.commands) for s in swarms if term.key in s.robots]
        whole = [(s.swarm[term.key], s.commands) for s in swarms if term.key in s.swarm]
        if each:
            mean, sd, far = _between(term, each)
            swarm_mean, swarm_sd, swarm_far = _between(term, whole)
            terms[term.key] = Spread(
                mean=tuple(mean.tolist()),
                sd=tuple(sd.tolist()),
                swarm_mean=tuple(swarm_mean.tolist()),
                swarm_sd=tuple(swarm_sd.tolist()),
                farthest=far,
                swarm_farthest=swarm_far,
            )
    return Reference(
        model=model,
        wheel_radius=float(np.mean(drive.wheel_radius)),
        axle=drive.axle,
        robots=sum(s.number for s in swarms),
        swarms=len(swarms),
        inherent=tuple(float(v) for v in inherent),
        terms=terms,
        structure=_structure([s.structure for s in swarms]),
        command=command,
    )


def _structure(swarms: Sequence[dict[str, FloatArray]]) -> dict[str, Structure]:
    """What healthy robots and swarms get for every flexible term."""
    found = {}
    for key in sorted({key for swarm in swarms for key in swarm}):
        each = [swarm[key] for swarm in swarms if key in swarm]
        rows = np.concatenate(each)
        pooled = np.array([pool(one[:, 0], one[:, 1]) for one in each])
        mean = float(np.mean(rows[:, 0]))
        sd, far = _beyond(rows - [mean, 0.0])
        swarm_sd, swarm_far = _beyond(pooled - [mean, 0.0])
        found[key] = Structure(
            mean=mean, sd=sd, swarm_sd=swarm_sd, farthest=far, swarm_farthest=swarm_far
        )
    return found


def _beyond(rows: FloatArray) -> tuple[float, float]:
    """Spread of (n, 2) values beyond their own errors, and the farthest of them."""
    own = float(np.median(rows[:, 1] ** 2))
    sd = float(np.sqrt(max(float(np.mean(rows[:, 0] ** 2)) - own, own / 9.0)))
    return sd, float(np.max(np.abs(rows[:, 0]) / np.hypot(rows[:, 1], sd)))


Fitted = tuple[Solo, FloatArray]


def _between(term: Term, fits: Sequence[Fitted]) -> tuple[FloatArray, FloatArray, float]:
    """(p,) robust mean, (p,) deviation beyond the fits' own uncertainty, and the farthest distance.

    The deviation never falls below a third of the typical uncertainty: robots differ by something.
    """
    rows = [
        np.stack(
            [
                strength(term, fit.coordinates, commands),
                uncertainty(term, fit.coordinates, fit.covariance),
            ],
            axis=1,
        )
        for (fit, _, _), commands in fits
    ]
    value, error = np.concatenate(rows)[:, 0], np.concatenate(rows)[:, 1]
    middle = np.median(value, axis=0)
    wide = SHRINK * np.median(np.abs(value - middle), axis=0)
    inside = np.abs(value - middle) <= OUTLYING * np.maximum(wide, 1e-12)
    mean = np.array([value[inside[:, k], k].mean() for k in range(value.shape[1])])
    total = np.array([value[inside[:, k], k].var() for k in range(value.shape[1])])
    known = np.isfinite(error) & (error < 1e3)
    own = np.array(
        [np.median(error[known[:, k], k]) if known[:, k].any() else 0.0 for k in range(len(mean))]
    )
    sd = np.sqrt(np.maximum(total - own**2, own**2 / 9.0))
    far = [
        np.where(
            gain > LEAST_GAIN,
            distance(term, fit.coordinates, fit.covariance, commands, mean, sd, jumped),
            0.0,
        )
        for (fit, gain, jumped), commands in fits
    ]
    return mean, sd, float(np.max(np.concatenate(far)))

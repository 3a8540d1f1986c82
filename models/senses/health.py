"""A healthy reference of the senses from healthy logs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.senses.cause import Belief
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.clock import shifts
from realitygap.models.senses.direct import noise_scale, of_robots
from realitygap.models.senses.glance import promises
from realitygap.models.senses.predicted import predict
from realitygap.models.senses.problem import SWARM, Problem, Term
from realitygap.models.senses.reference import INHERENT, Health, Level, SenseReference, away
from realitygap.models.senses.sight import Sight
from realitygap.models.senses.structure import Structure
from realitygap.models.senses.structure_health import Sizes, of_healthy

NORMAL = 1.4826
LEAST_ERROR = 1e-9


class Seen(NamedTuple):
    """One term of one healthy robot or swarm."""

    key: str
    swarm: bool
    value: FloatArray
    error: FloatArray
    gain: float


class Healthy(NamedTuple):
    """One healthy log."""

    robots: int
    seen: list[Seen]
    noise: FloatArray
    noise_error: FloatArray
    targets: float
    targets_error: float
    silent: float
    clock: FloatArray
    """(robots,) s, NaN where the readings do not tell."""
    clock_error: FloatArray
    structure: Sizes
    """Of every flexible term."""


def inherent_of(sight: Sight, model: PointModel) -> dict[str, float]:
    """Coordinates of the inherent terms that show in one healthy log."""
    problem = Problem(sight, model, [Belief()] * len(sight.robots), sight.free)
    terms = tuple(Term(sense_causes()[name]) for name in INHERENT)
    fit = problem.fit(terms, np.zeros(len(terms)))
    columns = [float(np.abs(c.values).max(initial=0.0)) for c in fit.columns]
    return {
        name: float(u)
        for name, u, size in zip(INHERENT, fit.coordinates, columns, strict=True)
        if size > 0.0
    }


def healthy_log(sight: Sight, model: PointModel, base: Belief) -> Healthy:
    """Every term of every robot of one healthy log, and of its swarm."""
    beliefs = [base] * len(sight.robots)
    problem = Problem(sight, model, beliefs, sight.free)
    kept = problem.fit((), np.zeros(0))
    seen = [
        Seen(p.term.key, p.term.robot == SWARM, p.coordinates, p.error, p.gain)
        for p in promises(problem, kept)
        if np.isfinite(p.gain)
    ]
    counts = predict(sight, model, beliefs)
    scale = noise_scale(sight, kept.residual, counts, sight.free)
    targets, error = of_robots(sight, model, counts, np.isfinite(sight.read))
    shift = shifts(problem)
    zeros = [
        float(np.nanmean(sight.read[sight.rows_of(k), s] == 0.0))
        for k in range(len(sight.robots))
        for s in range(8)
        if np.isfinite(sight.read[sight.rows_of(k), s]).any()
    ]
    return Healthy(
        robots=len(sight.robots),
        seen=seen,
        noise=scale.value,
        noise_error=scale.error,
        targets=targets,
        targets_error=error,
        silent=max(zeros, default=1.0),
        clock=shift.seconds,
        clock_error=shift.error,
        structure={
            f.key: np.stack([f.size, f.error], axis=1) for f in Structure(problem, kept).follows
        },
    )


def make_sense_reference(
    logs: Sequence[Healthy], inherent: dict[str, float], *, model: str, command: str
) -> SenseReference:
    """One reference from many healthy logs."""
    keys = sorted({one.key for log in logs for one in log.seen})
    terms = {}
    for key in keys:
        mine = [one for log in logs for one in log.seen if one.key == key]
        private = [one for one in mine if not one.swarm]
        shared = [one for one in mine if one.swarm]
        mean, sd, far, gain = _spread(private)
        swarm_mean, swarm_sd, swarm_far, swarm_gain = _spread(shared)
        terms[key] = Health(
            mean=mean,
            sd=sd,
            swarm_mean=swarm_mean,
            swarm_sd=swarm_sd,
            farthest=far,
            swarm_farthest=swarm_far,
            gain=gain,
            swarm_gain=swarm_gain,
        )
    noise = np.concatenate([log.noise for log in logs])
    noise_error = np.concatenate([log.noise_error for log in logs])
    swarm = np.array([_median(log.noise) for log in logs])
    targets = np.array([log.targets for log in logs])
    clock = np.concatenate([log.clock for log in logs])
    structure, joint = of_healthy([log.structure for log in logs])
    return SenseReference(
        model=model,
        robots=sum(log.robots for log in logs),
        swarms=len(logs),
        inherent=inherent,
        terms=terms,
        noise=_level(noise, noise_error, swarm),
        targets=_level(targets, np.array([log.targets_error for log in logs]), targets),
        clock=_level(clock, np.concatenate([log.clock_error for log in logs]), np.zeros(0)),
        structure=structure,
        joint=joint,
        silent=max((log.silent for log in logs), default=1.0),
        command=command,
    )


def _spread(
    seen: Sequence[Seen],
) -> tuple[tuple[float, ...], tuple[float, ...], float, float]:
    """Mean, standard deviation beyond the errors, farthest, largest gain."""
    if not seen:
        return (), (), 0.0, 0.0
    value = np.array([one.value for one in seen])
    error = np.array([one.error for one in seen])
    error = np.where(np.isfinite(error), error, 0.0)
    moved = error > 0.0
    usable = np.where(moved, value, 0.0)
    mean = np.median(usable, axis=0)
    wide = np.std(usable - mean, axis=0)
    sd = np.sqrt(np.maximum(wide**2 - np.median(error, axis=0) ** 2, (0.5 * wide) ** 2))
    far = max(away(one.value, one.error, mean, sd) for one in seen)
    gain = max(one.gain for one in seen)
    return tuple(mean.tolist()), tuple(sd.tolist()), far, max(gain, 0.0)


def _median(values: FloatArray) -> float:
    """Of those that are known; NaN where none is."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else math.nan


def _level(value: FloatArray, error: FloatArray, swarm: FloatArray) -> Level | None:
    known = np.isfinite(value)
    if not known.any():
        return None
    mean = float(np.median(value[known]))
    wide = float(np.std(value[known]))
    sd = float(np.sqrt(max(wide**2 - float(np.median(error[known])) ** 2, (0.5 * wide) ** 2)))
    swarm_sd = float(np.std(swarm[np.isfinite(swarm)])) if np.isfinite(swarm).any() else 0.0
    far = np.abs(value[known] - mean) / np.hypot(error[known], sd)
    mine = np.abs(swarm[np.isfinite(swarm)] - mean) / max(swarm_sd, LEAST_ERROR)
    return Level(
        mean=mean,
        sd=sd,
        swarm_sd=swarm_sd,
        farthest=float(far.max(initial=0.0)),
        swarm_farthest=float(mine.max(initial=0.0)),
    )

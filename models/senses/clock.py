"""A late tracker told from late commands: the sensors are on the robot's own clock.

A clock offset shifts poses against what the sensors read at a moment; commands that reach the
motors late do not. Poses and encoders may say the same of both, or there may be no encoders.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion, causes
from realitygap.models.causes.withheld import withheld
from realitygap.models.diagnosis import Unexplained
from realitygap.models.identify.hypothesis import Term
from realitygap.models.identify.value import told
from realitygap.models.information import inverted
from realitygap.models.naming.findings import Named
from realitygap.models.senses.predicted import predict
from realitygap.models.senses.problem import DEGREES, STRETCH, Problem
from realitygap.models.senses.reference import Level
from realitygap.models.senses.sight import Rows, Sight
from realitygap.models.sensing import HALF

TWINS = ("clock_offset", "command_latency")
STEP = 0.004
"""s by which poses are shifted to see what that does to the readings."""
TURNED = 0.01
"""rad by which the ring is turned likewise: a turned ring or marker is no shift in time."""
CLEARLY = 9.0
"""Deviance by which one twin must explain the sensors better: three standard deviations."""
LEAST_ERROR = 0.001
"""s: the sensors are never taken to tell a shift more closely."""
ITERATIONS = 5


class Shift(NamedTuple):
    """By how much poses are late against the readings."""

    seconds: FloatArray
    """(robots,) NaN where the readings do not tell."""
    error: FloatArray
    """(robots,) by blocks."""


def shifts(problem: Problem) -> Shift:
    """Fit each robot's shift beside a turn of its ring."""
    sight, beliefs = problem.sight, problem.base
    late = sight.poses + STEP * _velocity(sight)
    turned = sight.poses + np.array([0.0, 0.0, TURNED])
    now = predict(sight, problem.model, beliefs)
    columns = [
        np.where(problem.use, (now - predict(replace(sight, poses=p), problem.model, beliefs)), 0.0)
        / (problem.noise * size)
        for p, size in ((late, STEP), (turned, TURNED))
    ]
    residual = problem.residual((), np.zeros(0))
    number = len(sight.robots)
    seconds, error = np.full(number, np.nan), np.full(number, np.inf)
    for k in range(number):
        rows = sight.rows_of(k)
        mine = np.stack([c[rows] for c in columns])
        seconds[k], error[k] = _fitted(mine, residual[rows], sight.block[rows])
    return Shift(seconds, error)


def _fitted(columns: FloatArray, start: FloatArray, block: Rows) -> tuple[float, float]:
    """The first of two linear coefficients, and its error by blocks; NaN where nothing tells."""
    if not columns[0].any():
        return float("nan"), float("inf")
    flat = columns.reshape(len(columns), -1)
    at = np.zeros(len(columns))
    for _ in range(ITERATIONS):
        left = start.ravel() + at @ flat
        pull = flat * ((DEGREES + 1.0) / (DEGREES + left**2))
        inverse = inverted(pull @ flat.T)
        at -= inverse.step(pull @ left)
    each = (pull * (start.ravel() + at @ flat)).reshape(len(columns), len(start), -1).sum(axis=2)
    label = np.unique(block, return_inverse=True)[1]
    meat = np.stack([np.bincount(label, one) for one in each]).astype(np.float64)
    variance = float(inverse.sandwich(meat @ meat.T)[0, 0])
    if not np.isfinite(variance):
        return float("nan"), float("inf")
    return float(at[0]), STRETCH * float(np.sqrt(variance))


def _velocity(sight: Sight) -> FloatArray:
    """(rows, 3) m/s, m/s, rad/s as measured, over the moments that poses are averaged over.

    0 at the ends of a robot's runs.
    """
    there, back = -HALF, HALF
    moved = np.roll(sight.poses, there, axis=0) - np.roll(sight.poses, back, axis=0)
    moved[:, 2] = (moved[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    took = np.roll(sight.time, there) - np.roll(sight.time, back)
    usual = float(np.median(took))
    inside = (took > 0.5 * usual) & (took < 1.5 * usual)
    for step in (there, back):
        inside &= np.roll(sight.robot, step) == sight.robot
    return np.asarray(np.where(inside[:, None], moved / np.where(inside, took, 1.0)[:, None], 0.0))


def told_apart(
    one: Named, robots: Sequence[int], shift: Shift, healthy: Level | None
) -> Named | Unexplained:
    """A name of motion with the sensors' word on which of the twins it is, or what is neither.

    Args:
        one: Named by motion.
        robots: Ids, in the order of `shift`.
        shift: Of poses against the readings.
        healthy: The same of healthy robots; None: it was not measured, and sensors say nothing.
    """
    twin = next((name for name in TWINS if name != one.term.cause.name), "")
    if healthy is None or one.term.cause.name not in TWINS:
        return one
    seen = _deviances(one, robots, shift, healthy)
    if seen is None:
        return one
    late, in_time = seen
    against = late - in_time if one.term.cause.name == "clock_offset" else in_time - late
    if against < -CLEARLY:
        return _alone(one)
    if against < CLEARLY:
        return one
    if withheld(twin):
        return _neither(one)
    possible = twin in {t.cause.name for t in (*one.twins, *one.evidence.rivals)}
    other = Term(causes()[twin], one.term.variant)
    seconds, (found, *_) = other.cause.parameters[0], one.values
    if not possible or seconds.kept(found.value) != found.value:
        return replace(one, twins=(other,))  # the encoders, or what is believed, contradict
    values = (told(seconds, found.value, found.low, found.high),)
    return _alone(replace(one, term=other, values=values))


def _alone(one: Named) -> Named:
    """Without the twin as a rival."""
    rivals = tuple(t for t in one.evidence.rivals if t.cause.name not in TWINS)
    return replace(one, twins=(), evidence=replace(one.evidence, rivals=rivals))


def _deviances(
    one: Named, robots: Sequence[int], shift: Shift, healthy: Level
) -> tuple[float, float] | None:
    """Of the sensors' shifts if poses are as late as named, and if they are not late at all."""
    mine = np.isin(np.asarray(robots), one.robots) & np.isfinite(shift.seconds)
    if not mine.any():
        return None
    weight = 1.0 / (shift.error[mine] ** 2 + healthy.sd**2)
    found = float((weight * shift.seconds[mine]).sum() / weight.sum()) - healthy.mean
    value = one.values[0]
    error = (value.high - value.low) / (2.0 * 1.96)
    wide = float(np.hypot(weight.sum() ** -0.5, LEAST_ERROR))
    return (found - value.value) ** 2 / (wide**2 + error**2), found**2 / wide**2


def _neither(one: Named) -> Unexplained:
    return Unexplained(
        channel="timing",
        share=one.evidence.share,
        where=(
            "it follows its commands late, and its sensors say that this is not "
            f"{one.term.cause.name}"
        ),
        quantity="change",
        robots="all" if one.whole_swarm else one.robots,
        distance=one.evidence.distance,
    )


def swapped(motion: Motion, old: Named, new: Named) -> Motion:
    """A motion found, with its delay where the sensors have put it."""
    if old.term.cause is new.term.cause:
        return motion
    seconds = old.values[0].value * (1.0 if new.term.cause.name == "clock_offset" else -1.0)
    drive = replace(motion.drive, latency=max(0.0, motion.drive.latency - seconds))
    return replace(motion, drive=drive, pose_delay=motion.pose_delay + seconds)

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
from realitygap.models.belief.catalogue import causes, withheld
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.senses.robot import LATE, SenseRobot
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.marginal import EMPTY, Prior, freed, integrated, root_of
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.engine.value import told
from realitygap.models.naming.findings import Named
from realitygap.models.naming.health.reference import Column
from realitygap.models.naming.rules import Rules

TWINS = ("clock_offset", "command_latency")
TURNED = ("ir_rotation.angle",)
"""A turned ring or marker is no shift in time: it is free beside it."""
LEAST_ERROR = 0.001
"""s: the sensors are never taken to tell a shift more closely. No rule: it keeps a ratio finite."""


class Shift(NamedTuple):
    """By how much poses are late against the readings."""

    seconds: FloatArray
    """(robots,) NaN where the readings do not tell."""
    error: FloatArray
    """(robots,)."""


@one_thread
def shifts(robots: Sequence[SenseRobot], health: Health) -> Shift:
    """Each robot's shift beside a turn of its ring, everything that healthy robots differ in
    integrated out."""
    names = robots[0].names
    prior, _ = health.on(names, robots[0].rules)
    seconds, error = np.full(len(robots), np.nan), np.full(len(robots), np.inf)
    if LATE not in names:
        return Shift(seconds, error)
    late = names.index(LATE)
    rest = np.flatnonzero(prior.at != late)
    inner = prior.root @ prior.root.T
    others = Prior(prior.at[rest], prior.mean[rest], root_of(inner[np.ix_(rest, rest)]))
    turned = np.array([k for k, name in enumerate(names) if name in TURNED], dtype=np.int64)
    for k, one in enumerate(robots):
        errors = one.own_errors
        slope = one.pulled(errors[:, None])[0]
        score = freed(integrated(one.information, slope, float(errors @ errors), others), turned)
        known = float(score.information[late, late])
        if known > EMPTY:
            seconds[k], error[k] = float(score.slope[late]) / known, known**-0.5
    return Shift(seconds, error)


def told_apart(
    one: Named,
    robots: Sequence[int],
    shift: Shift,
    healthy: Column | None,
    rules: Rules = Rules(),
) -> Named | Unexplained:
    """A name of motion with the sensors' word on which of the twins it is, or what is neither.

    Args:
        one: Named by motion.
        robots: Ids, in the order of `shift`.
        shift: Of poses against the readings.
        healthy: The same of healthy robots; None: it was not measured, and sensors say nothing.
        rules: How clearly they must say it.
    """
    twin = next((name for name in TWINS if name != one.term.cause.name), "")
    if healthy is None or one.term.cause.name not in TWINS:
        return one
    seen = _deviances(one, robots, shift, healthy)
    if seen is None:
        return one
    late, in_time = seen
    against = late - in_time if one.term.cause.name == "clock_offset" else in_time - late
    if against < -rules.clocks:
        return _alone(one)
    if against < rules.clocks:
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
    one: Named, robots: Sequence[int], shift: Shift, healthy: Column
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

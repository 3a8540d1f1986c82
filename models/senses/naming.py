"""Findings in the senses as the diagnosis names causes: robots, values with intervals, evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.cause import ALL
from realitygap.models.identify import hypothesis as motion
from realitygap.models.identify.value import Value, told
from realitygap.models.naming.findings import Evidence, Named
from realitygap.models.senses.cause import SenseCause
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.nest import NestFound
from realitygap.models.senses.problem import SWARM
from realitygap.models.senses.reference import SenseReference
from realitygap.models.senses.select import Found
from realitygap.models.senses.sight import Bools

NOMINAL = 1.96
"""Standard deviations of a normal variable on each side of 95 %."""
LEAST_SWARM = 3
ABOVE_ZERO = 3.0
"""counts of offset from which readings are no longer cut off at zero, which is what the inherent
offset stands for."""
SURE = 99.0
"""Distance from health told of a sensor that is simply dead, in standard deviations."""


def fitted_named(
    found: Sequence[Found], robots: tuple[int, ...], healthy: SenseReference
) -> tuple[Named, ...]:
    """Fitted terms, less what healthy robots get for them."""
    named = []
    for one in found:
        swarm = one.term.robot == SWARM
        mean, sd = healthy.spread(one.term.key, one.term.size, swarm=swarm)
        change = one.coordinates - mean
        if one.term.cause.name == "ir_offset" and change[0] > ABOVE_ZERO:
            change = change + healthy.inherent.get("ir_offset", 0.0)
        evidence = _evidence(
            one.term.cause, one.term.variant, one.coordinates, one.gain, one.share, one.distance
        )
        rivals = tuple(motion.Term(t.cause, t.variant) for t in one.rivals)
        named.append(
            _named(
                one.term.cause,
                one.term.variant,
                robots if swarm else (robots[one.term.robot],),
                _values(one.term.cause, change, np.hypot(one.error, sd)),
                evidence,
                shared=swarm and len(robots) >= LEAST_SWARM,
                rivals=rivals,
                gains=one.gains,
            )
        )
    return tuple(named)


def dead_named(blind: Bools, robots: tuple[int, ...]) -> tuple[Named, ...]:
    """Sensors that are dead: (robots, 16), infrared before light."""
    named = []
    half = blind.shape[1] // 2
    for k, column in np.argwhere(blind).tolist():
        name = "ir_dead_sensor" if column < half else "ls_dead_sensor"
        cause, word = sense_causes()[name], str(column % half)
        evidence = _evidence(cause, word, np.zeros(0), 0.0, 1.0, SURE)
        named.append(_named(cause, word, (robots[k],), (), evidence))
    return tuple(named)


def noise_named(
    noisy: Sequence[tuple[float, float, bool]], robots: tuple[int, ...]
) -> tuple[Named, ...]:
    """Robots with other noise: (logarithm of scale, error, shared by the swarm).

    Robots whose noise nobody could tell have an infinite error: they share what the others do, and
    say nothing of it.
    """
    cause = sense_causes()["ir_noise"]
    named = []
    shared = [(u, e) for u, e, swarm in noisy if swarm and u != 0.0 and np.isfinite(e)]
    if shared:
        value = np.array([float(np.median([u for u, _ in shared]))])
        error = np.array([float(np.median([e for _, e in shared])) / len(shared) ** 0.5])
        evidence = _evidence(cause, ALL, value, 0.0, 1.0, float(abs(value[0]) / error[0]))
        values = _values(cause, value, error)
        named.append(_named(cause, ALL, robots, values, evidence, shared=True))
    for robot, (u, e, swarm) in zip(robots, noisy, strict=True):
        if u != 0.0 and not swarm:
            value, error = np.array([u]), np.array([e])
            evidence = _evidence(cause, ALL, value, 0.0, 1.0, abs(u) / e)
            named.append(_named(cause, ALL, (robot,), _values(cause, value, error), evidence))
    return tuple(named)


def nest_named(found: Sequence[NestFound]) -> tuple[Named, ...]:
    """Changes of the nest."""
    named = []
    for one in found:
        cause = sense_causes()[one.name]
        evidence = _evidence(cause, ALL, one.coordinates, one.gain, one.share, one.distance)
        named.append(
            _named(
                cause,
                ALL,
                one.robots,
                _values(cause, one.coordinates, one.error),
                evidence,
                shared=one.whole_swarm,
                rivals=tuple(motion.Term(sense_causes()[name], ALL) for name in one.rivals),
            )
        )
    return tuple(named)


def _values(cause: SenseCause, coordinates: FloatArray, error: FloatArray) -> tuple[Value, ...]:
    """Physical values with 95 % intervals."""
    found = []
    for p, u, e in zip(cause.parameters, coordinates, error, strict=True):
        half = NOMINAL * float(np.hypot.reduce([e, p.doubt * abs(u), p.unsure]))
        found.append(told(p, *(p.believed(float(v)) for v in (u, u - half, u + half))))
    return tuple(found)


def _evidence(
    cause: SenseCause,
    variant: str,
    coordinates: FloatArray,
    gain: float,
    share: float,
    distance: float,
) -> Evidence:
    return Evidence(
        term=motion.Term(cause, variant),
        coordinates=coordinates,
        covariance=np.zeros((len(coordinates), len(coordinates))),
        gain=gain,
        share=share,
        distance=distance,
    )


def _named(
    cause: SenseCause,
    variant: str,
    robots: tuple[int, ...],
    values: tuple[Value, ...],
    evidence: Evidence,
    *,
    shared: bool = False,
    rivals: tuple[motion.Term, ...] = (),
    gains: tuple[tuple[str, float], ...] = (),
) -> Named:
    """A cause with whose it is: of the place, whose robots all have it, however many they are; of
    all robots, where a swarm shares it; or of those given."""
    return Named(
        term=motion.Term(cause, variant),
        robots=robots,
        whole_swarm=cause.place or shared,
        values=values,
        evidence=replace(evidence, rivals=rivals, gains=gains or ((cause.name, evidence.gain),)),
        twins=(),
    )

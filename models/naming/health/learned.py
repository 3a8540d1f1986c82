"""A healthy reference from healthy logs: the inherent motion, and how robots differ about it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import ALL
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.robot import robots_of
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.health import Health, Told, farthest, healthy
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.state import SWARM, State
from realitygap.models.naming.engine.subject import Subject
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.health.reference import INHERENT, Column, Reference
from realitygap.models.naming.rules import Rules

STARTS = ((0.0, 0.0, -0.005, 0.009, -0.2, 0.0), (0.0, 0.0, 0.02, 0.05, -0.5, 0.0))
"""Coordinates from which the inherent motion is fitted: motors of several kinds. No rule: where
iterations begin."""
ROUNDS = 2
"""Times the noise is learned anew at the inherent motion found. No rule: a limit of iterations."""


@one_thread
def fit_inherent(tracks: Tracks, drive: Drive) -> FloatArray:
    """(6,) coordinates of the inherent motion of one swarm, all robots together.

    First by single windows' errors, then with what every window has of its own integrated out: what
    only single windows show is no robot's.
    """
    robots = len(tracks.robots)
    plain = [Motion(drive=drive)] * robots
    problem = Problem(tracks, plain, groups=np.zeros(robots, dtype=int))
    term = Term(INHERENT, ALL)
    found = problem.fit((term,), [np.array([start]) for start in STARTS]).coordinates[0]
    for _ in range(ROUNDS):
        motion = INHERENT.applied(plain[0], found)
        there = robots_of(tracks, [motion] * robots, doses=False)
        fitter = Fitter(Weighed(State(tracks, tuple(plain), tuple(there), NOBODY)), SWARM)
        fit = fitter.fit([term], [found])
        if fit is None:
            break
        (found,) = fit.coordinates
    return np.asarray(found)


NOBODY = Health((), np.zeros(0), np.zeros((0, 0)), np.zeros(0), 0, 0)


@one_thread
def told_of(tracks: Tracks, motion: Motion) -> Told:
    """What a healthy swarm's windows say of every coefficient."""
    return told_by(robots_of(tracks, [motion] * len(tracks.robots), doses=False))


def told_by(robots: Sequence[Subject]) -> Told:
    """What the robots of a healthy swarm say of every coefficient that is linear."""
    names = robots[0].names
    at = np.array([k for k, name in enumerate(names) if "@" not in name], dtype=np.int64)
    return Told(
        tuple(names[k] for k in at),
        np.array([one.information[np.ix_(at, at)] for one in robots]),
        np.array([one.pulled(one.own_errors[:, None])[0, at] for one in robots]),
    )


def make_reference(
    swarms: Sequence[Told],
    inherent: FloatArray,
    *,
    model: str,
    drive: Drive,
    command: str,
    rules: Rules = Rules(),
) -> Reference:
    """Put healthy swarms together.

    Args:
        swarms: Of sound robots only.
        inherent: (6,) coordinates of their common motion.
        model: The model's name.
        drive: The model's.
        command: What the user typed, for the record.
        rules: What naming is tuned to.
    """
    return Reference(
        wheel_radius=float(np.mean(drive.wheel_radius)),
        axle=drive.axle,
        inherent=tuple(float(v) for v in inherent),
        **spreads(swarms, model=model, command=command, rules=rules),
    )


def spreads(
    swarms: Sequence[Told], *, model: str, command: str, rules: Rules = Rules()
) -> dict[str, Any]:
    """The fields of any reference: how robots and swarms differ, and the gates."""
    learned = healthy(swarms, rules)
    sd = np.sqrt(np.diag(learned.covariance))
    causes = [k for k, name in enumerate(learned.names) if "." in name and sd[k] > 0.0]
    block = learned.covariance[np.ix_(causes, causes)] / sd[causes][:, None] / sd[causes]
    cause, flexible = farthest(learned, swarms, rules)
    return {
        "model": model,
        "robots": learned.robots,
        "swarms": learned.swarms,
        "columns": {
            name: Column(mean=float(m), sd=float(s), swarm_sd=float(np.sqrt(w)))
            for name, m, s, w in zip(learned.names, learned.mean, sd, learned.swarm, strict=True)
        },
        "causes": tuple(learned.names[k] for k in causes),
        "correlation": tuple(tuple(float(v) for v in row) for row in block),
        "gates": Gates(
            cause=max(rules.cause_gate, rules.gate_margin * cause),
            flexible=max(rules.flexible_gate, rules.gate_margin * flexible),
        ),
        "command": command,
    }


def with_errors(reference: Reference, farthest: Sequence[float]) -> Reference:
    """The reference with what its healthy logs' predictions are off at most, by log."""
    gates = reference.gates
    error = max(gates.error, gates.margin * max(farthest, default=0.0))
    return reference.model_copy(update={"gates": gates.model_copy(update={"error": error})})

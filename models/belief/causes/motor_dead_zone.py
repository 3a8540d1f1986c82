"""A motor does not turn at slow commands."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter, sides
from realitygap.models.belief.motion import Motion

SCANNED = 14
"""Thresholds tried: between neighbouring commanded speeds, evenly by how often they occur."""
SEEN = 0.01
"""Share of a log's commands that must be slower than a dead zone for it to show: a second or two of
each wheel in two minutes. In less, one bad start of a motor looks like a dead zone."""
SLOW = 0.6
"""Of the fastest command: a wheel that needs more to turn at all is another fault."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    threshold = float(values[0])
    affected = sides(variant)
    pair = motion.drive.dead_zone
    left, right = (max(p, threshold) if a else p for p, a in zip(pair, affected, strict=True))
    return replace(motion, drive=replace(motion.drive, dead_zone=(left, right)))


def _starts(commands: FloatArray) -> list[FloatArray]:
    speed = np.sort(np.abs(commands).ravel())
    speed = speed[speed > 0.0]
    slow = speed[(speed >= least_seen(commands)) & (speed < SLOW * speed.max(initial=0.0))]
    if not len(slow):
        return []
    # finer towards the slowest: a dead zone is small
    levels = np.quantile(slow, np.linspace(0.0, 1.0, SCANNED) ** 2)
    return [np.array([level * (1.0 + 1e-6)]) for level in np.unique(levels)]


def least_seen(commands: FloatArray) -> float:
    """rad/s: the smallest dead zone that this log could show; infinite where nothing is slow."""
    speed = np.sort(np.abs(commands).ravel())
    moving = speed[speed > 0.0]
    rank = int(np.ceil(SEEN * len(moving)))
    return float(moving[rank]) if rank < len(moving) else math.inf


CAUSE = Cause(
    name="motor_dead_zone",
    meaning="a motor does not turn when told to turn slowly",
    plain="Commands below {threshold} do not turn {whose} {which}. Look for friction in the gears.",
    parameters=(
        Parameter(name="threshold", unit="rad/s", null=0.0, low=0.0, high=1000.0, step=2e-2),
    ),
    change=_change,
    variants=("left", "right", "both"),
    word="wheel",
    confusable_with=("wheel_radius_scale",),
    experiment="slow-ramp",
    smooth=False,
    starts=_starts,
)

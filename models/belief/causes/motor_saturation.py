"""A motor cannot turn as fast as commanded."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter, sides
from realitygap.models.belief.motion import Motion

STARTS = (0.97, 0.85, 0.6)
"""Shares of the fastest command to start from."""
FASTEST = 1000.0
"""rad/s: no small robot's wheel turns faster."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    limit = float(values[0])
    affected = sides(variant)
    pair = motion.drive.speed_limit
    left, right = (min(p, limit) if a else p for p, a in zip(pair, affected, strict=True))
    return replace(motion, drive=replace(motion.drive, speed_limit=(left, right)))


def starts(commands: FloatArray) -> list[FloatArray]:
    """(1,) limits to start from, rad/s."""
    fastest = float(np.abs(commands).max(initial=0.0))
    return [np.array([share * fastest]) for share in STARTS]


CAUSE = Cause(
    name="motor_saturation",
    meaning="a motor cannot turn as fast as it is told to",
    plain="{Whose} {which} cannot turn faster than {limit}. Check the battery, the motor and its "
    "gear.",
    parameters=(
        Parameter(name="limit", unit="rad/s", null=math.inf, low=1e-3, high=FASTEST, step=2e-2),
    ),
    change=_change,
    variants=("left", "right", "both"),
    word="wheel",
    confusable_with=("wheel_radius_scale", "wheel_radius_mismatch"),
    experiment="straights",
    starts=starts,
)

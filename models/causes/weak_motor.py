"""The motors have less torque than they should: wheels change speed slowly."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from embedded_sim import Drive
from embedded_sim.model import FloatArray, Pair
from models.causes.cause import Cause, Parameter
from models.causes.motion import Motion

TORQUE = 0.0076
"""N m, most an e-puck's motor gives: 3.8 m/s^2 with 0.15 kg on 20.5 mm wheels whose motors add
1e-5 kg m^2 each. Our choice."""
ACCELERATION = 185.0
"""rad/s^2 that `TORQUE` gives the wheels of such a robot (T over its own inertia and half the
robot's mass at the wheel's radius): taken where no healthy reference says what the motors can
do."""
STARTS = (-0.4, -1.5)
"""Coordinates to start from: two thirds and a fifth of the torque."""
ELSEWHERE = 0.03
"""What a latency of 2 to 6 ms, too short to be named, feigns of a swarm: up to 15 % less torque, a
fifth of which counts as one standard deviation."""
FEIGNS = {
    "command_latency": 0.0025,
    "clock_offset": 0.0025,
    "motor_lag": 0.008,
    "wheel_separation": 0.0035,
    "wheel_radius_scale": 0.0015,
    "speed_droop": 1.5e-5,
    "tracker_offset": 1e-4,
}
"""As for `low_friction`, with a fifth to two thirds of the torque."""


def limited(drive: Drive, share: float) -> Pair:
    """rad/s^2: the wheels' acceleration limits at a share of the nominal torque."""
    left, right = drive.acceleration
    if math.isinf(left):
        return (ACCELERATION * share,) * 2 if share < 1.0 else (left, right)
    return left * share, right * share


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    limits = limited(motion.drive, float(values[0]) / TORQUE)
    return replace(motion, drive=replace(motion.drive, acceleration=limits))


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


CAUSE = Cause(
    name="weak_motor",
    meaning="the motors give less torque than they should: the wheels change speed slowly",
    parameters=(
        Parameter(
            name="torque",
            unit="N m",
            null=TORQUE,
            low=0.003 * TORQUE,
            high=3.0 * TORQUE,
            step=5e-2,
            link="factor",
            sign=-1,
            doubt=0.05,
            elsewhere=ELSEWHERE,
        ),
    ),
    change=_change,
    family="transient",
    feigns=FEIGNS,
    confusable_with=("low_friction", "motor_lag"),
    twins=("low_friction",),
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=_starts,
)

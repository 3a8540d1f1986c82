"""The motors have less torque than they should: wheels change speed slowly.

Told is the share of a healthy robot's torque: acceleration grows in step with it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.grip import HEALTHY, LEAST, limits, told_against
from realitygap.models.belief.motion import Motion

STARTS = (-0.4, -1.5)
"""Coordinates to start from: two thirds and a fifth of the torque."""
FEIGNS = {
    "command_latency": 0.0025,
    "clock_offset": 0.0025,
    "motor_lag": 0.008,
    "wheel_separation": 0.0035,
    "wheel_radius_scale": 0.0015,
    "speed_droop": 1.5e-5,
    "tracker_offset": 1e-4,
}
"""As for `low_friction`, by injecting weak motors: with a fifth to two thirds of the torque."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    weak = limits(motion, values)
    return replace(motion, drive=replace(motion.drive, acceleration=weak))


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


CAUSE = Cause(
    name="weak_motor",
    meaning="the motors give a share only of a healthy robot's torque: the wheels change speed "
    "slowly",
    plain="{Whose} motors give {torque:%} of a healthy robot's torque. Check the battery and the "
    "gears.",
    parameters=(
        Parameter(
            name="torque",
            unit="1",
            null=1.0,
            low=LEAST,
            high=3.0,
            step=5e-2,
            link="factor",
            sign=-1,
            doubt=0.05,
        ),
    ),
    change=_change,
    given=(HEALTHY,),
    told_against=told_against,
    family="transient",
    feigns=FEIGNS,
    confusable_with=("low_friction", "motor_lag"),
    twins=("low_friction",),
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=_starts,
)

"""A ramp limits how fast the wheels change speed.

The same term as a weak motor's, told in its own unit where nobody knows how fast a healthy robot's
wheels change speed. Where a reference knows, `weak_motor` tells it as a share of that.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.grip import HEALTHY
from realitygap.models.belief.motion import Motion

STARTS = (0.1, 0.5, 2.0)
"""s from rest to the log's fastest command, to start from."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    left, right = (min(own, float(values[0])) for own in motion.drive.acceleration)
    return replace(motion, drive=replace(motion.drive, acceleration=(left, right)))


def _starts(commands: FloatArray) -> list[FloatArray]:
    fastest = float(np.abs(commands).max(initial=0.0))
    return [np.array([fastest / seconds]) for seconds in STARTS if fastest > 0.0]


CAUSE = Cause(
    name="slew_limit",
    meaning="a ramp, or motors of little torque, limit how fast the wheels change speed",
    plain="{Whose} wheels change speed by at most {rate}. Look for a ramp in the firmware, and at "
    "the motors' torque.",
    parameters=(
        Parameter(
            name="rate", unit="rad/s^2", null=math.inf, low=1e-2, high=HEALTHY.high, step=1e-1
        ),
    ),
    change=_change,
    where="unmeasured",
    family="transient",
    confusable_with=("motor_lag", "command_latency", "start_delay"),
    experiment="steps",
    starts=_starts,
)

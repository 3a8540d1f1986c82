"""The motors approach a commanded speed gradually."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from embedded_sim.model import FloatArray
from models.causes.cause import Cause, Parameter
from models.causes.motion import Motion

ORDER = 1.06
"""Two lags in a row look like one whose ORDER-th power is the sum of theirs: 1 where they just add.
Measured with 25 and 50 ms behind the nominal world's motors."""
STARTS = (0.02, 0.1)
"""s to start from: at the null a lag hides behind the motors' own."""
FEIGNS = {
    "command_latency": 0.0038,
    "clock_offset": 0.0038,
    "weak_motor": 0.23,
    "low_friction": 0.23,
    "wheel_separation": 0.0017,
    "wheel_radius_scale": 0.0009,
    "speed_droop": 1e-5,
}
"""As for `low_friction`, with 15 to 100 ms."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    lag = float(values[0])
    if lag == 0.0:
        return motion
    power = motion.drive.time_constant**ORDER + math.copysign(abs(lag) ** ORDER, lag)
    constant = max(0.0, power) ** (1.0 / ORDER)
    return replace(motion, drive=replace(motion.drive, time_constant=constant))


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


CAUSE = Cause(
    name="motor_lag",
    meaning="the motors answer as a first-order lag: speed approaches the command gradually",
    parameters=(
        Parameter(
            name="time_constant",
            unit="s",
            null=0.0,
            low=-0.1,
            high=1.0,
            step=2e-3,
            sign=1,
            doubt=0.04,
        ),
    ),
    change=_change,
    family="transient",
    feigns=FEIGNS,
    confusable_with=("command_latency", "weak_motor", "low_friction"),
    experiment="steps",
    starts=_starts,
)

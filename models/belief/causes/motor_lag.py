"""The motors approach a commanded speed gradually."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion

RUSH, RUSHED = 0.226, 4.2
"""Largest logarithm of what a lag seems to add to the motors' acceleration, and the rad/s that the
motors would gain in one time constant where it does. The point model's motor lags behind its
command from the first moment; a real one first follows the lag as fast as it can, so that its limit
matters less, and not at all once the lag is slower than the motor. Measured by injecting lags of 8
to 100 ms into the rigid-body world."""
STARTS = (0.02, 0.1)
"""s to start from: at the null a lag hides behind the motors' own."""
FEIGNS = {
    "command_latency": 0.0035,
    "clock_offset": 0.0035,
    "weak_motor": 0.1,
    "low_friction": 0.1,
    "wheel_separation": 0.0017,
    "wheel_radius_scale": 0.0009,
    "speed_droop": 1e-5,
}
"""As for `low_friction`, by injecting lags of 15 to 100 ms."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    lag = float(values[0])
    if lag == 0.0:
        return motion
    drive = motion.drive
    left, right = drive.acceleration
    faster = _rush(lag, min(left, right))
    return replace(
        motion,
        drive=replace(
            drive,
            time_constant=max(0.0, drive.time_constant + lag),
            acceleration=(left * faster, right * faster),
        ),
    )


def _rush(lag: float, acceleration: float) -> float:
    """How much faster the motors seem to change speed."""
    if lag <= 0.0 or math.isinf(acceleration):
        return 1.0
    gained = lag * acceleration / RUSHED
    return math.exp(RUSH * (gained * math.exp(1.0 - gained)) ** 3)


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


CAUSE = Cause(
    name="motor_lag",
    meaning="the motors answer as a first-order lag: speed approaches the command gradually",
    plain="{Whose} motors need {time_constant} for two thirds of a change of speed. Check the "
    "battery and the speed controllers.",
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

"""A wheel stands for a while before it starts, or before it turns the other way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion

STARTS = (0.05, 0.2, 0.5)
"""s to start from: longer waits than the steps of commands are far from linear."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    delay = motion.drive.start_delay + float(values[0])
    return replace(motion, drive=replace(motion.drive, start_delay=delay))


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


CAUSE = Cause(
    name="start_delay",
    meaning="a wheel stands for a while before it starts, or before it turns the other way",
    plain="{Whose} wheels stand for {seconds} before they start or turn the other way. Look at the "
    "motor driver's enabling and braking, and for play in the gears.",
    parameters=(
        Parameter(
            name="seconds", unit="s", null=0.0, low=0.0, high=3.0, step=5e-3, sign=1, doubt=0.015
        ),
    ),
    change=_change,
    family="transient",
    confusable_with=("command_latency", "motor_lag", "motor_dead_zone"),
    experiment="steps",
    starts=_starts,
)

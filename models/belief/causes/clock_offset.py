"""The tracker's clock is not the robot's: poses carry a late or early stamp."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.causes.command_latency import FEIGNS, UNSURE
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return replace(motion, pose_delay=motion.pose_delay + float(values[0]))


STARTS = (0.15, 0.05, -0.05)
"""s to start from: a delay as long as commands last looks like none in its first millisecond."""


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


CAUSE = Cause(
    name="clock_offset",
    meaning="the tracker's clock is offset from the robots': poses are stamped late (early if < 0)",
    plain="{Whose} poses are stamped {seconds:late/early}. Synchronise the tracker's clock with "
    "the robot's.",
    parameters=(
        Parameter(
            name="seconds",
            unit="s",
            null=0.0,
            low=-1.0,
            high=1.0,
            step=1e-3,
            unsure=UNSURE,
        ),
    ),
    change=_change,
    family="transient",
    feigns=FEIGNS,
    exact=True,
    confusable_with=("command_latency",),
    twins=("command_latency",),
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=_starts,
)

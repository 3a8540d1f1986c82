"""The wheels slip when they speed up or brake: the floor or the tyres are smooth.

Told is the share of the healthy acceleration at which they begin to slip. A healthy robot's wheels
hold all that its motors give, so that grip beyond that does not show: a share is never above 1, and
is no ratio of coefficients of friction, which is smaller.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.grip import HEALTHY, LEAST, limits, told_against
from realitygap.models.belief.motion import Motion

STARTS = (-0.6, -1.4)
"""Coordinates to start from: a half and a quarter of what healthy wheels' grip gives."""
FEIGNS = {
    "command_latency": 0.0105,
    "clock_offset": 0.0105,
    "motor_lag": 0.021,
    "wheel_separation": 0.014,
    "wheel_radius_scale": 0.002,
    "speed_droop": 2.5e-5,
    "tracker_offset": 1e-4,
}
"""Measured by injecting this very effect into the rigid-body world: 25 robots of it with a friction
of 0.05 to 0.3, as what two minutes give beyond their uncertainty; so those of the other causes.
They are that world's, and may be other on other floors."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    slipping = limits(motion, values)
    if slipping >= motion.drive.acceleration:
        return motion  # the motors give less than the wheels can hold
    return replace(
        motion,
        drive=replace(motion.drive, acceleration=slipping),
        encoder_drive=motion.wheels,
    )


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


def _as_twin(without: Motion, weak: Motion) -> float | None:
    share = min(weak.drive.acceleration) / min(without.drive.acceleration)
    return share if share < 1.0 else None


CAUSE = Cause(
    name="low_friction",
    meaning="the wheels slip on the floor when they speed up or brake, from a share of the healthy "
    "acceleration on",
    plain="{Whose} wheels slip beyond {friction:%} of a healthy robot's acceleration. Clean "
    "tyres and floor.",
    parameters=(
        Parameter(
            name="friction",
            unit="1",
            null=1.0,
            low=LEAST,
            high=1.0,
            step=5e-2,
            link="factor",
            sign=-1,
            doubt=0.06,
        ),
    ),
    change=_change,
    given=(HEALTHY,),
    told_against=told_against,
    family="transient",
    feigns=FEIGNS,
    confusable_with=("weak_motor", "motor_lag"),
    twins=("weak_motor",),
    as_twin=_as_twin,
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=_starts,
)

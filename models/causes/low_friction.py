"""The wheels slip when they speed up or brake: the floor or the tyres are smooth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from embedded_sim.model import FloatArray
from models.causes.cause import Cause, Parameter
from models.causes.motion import Motion

FRICTION = 1.2
"""Of an e-puck's rubber tyre on the floor. Our choice."""
TRACTION = 290.0
"""rad/s^2 of 20.5 mm wheels per unit of friction, measured on the nominal robot at 0.15 to 0.2: g
times the wheels' share of the weight (0.73, the centre of mass being 8 mm ahead of the axle and the
skid 30 mm) over the radius, times 0.83, because wheels that slip also slide sideways."""
STARTS = (-1.2, -2.0)
"""Coordinates to start from: friction of 0.36 and 0.16."""
FEIGNS = {
    "command_latency": 0.0105,
    "clock_offset": 0.0105,
    "motor_lag": 0.021,
    "wheel_separation": 0.014,
    "wheel_radius_scale": 0.002,
    "speed_droop": 2.5e-5,
    "tracker_offset": 1e-4,
}
"""Measured in 25 robots of the nominal world with a friction of 0.05 to 0.3, as what two minutes
give beyond their uncertainty; so those of the other causes."""


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    friction = float(values[0])
    most = TRACTION * friction
    left, right = motion.drive.acceleration
    if friction >= FRICTION or most >= min(left, right):
        return motion
    return replace(
        motion,
        drive=replace(motion.drive, acceleration=(most, most)),
        encoder_drive=motion.wheels,
    )


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([start]) for start in STARTS]


def _as_twin(without: Motion, weak: Motion) -> float | None:
    friction = min(weak.drive.acceleration) / TRACTION
    return friction if friction < FRICTION else None


CAUSE = Cause(
    name="low_friction",
    meaning="the wheels slip on the floor when they speed up or brake",
    parameters=(
        Parameter(
            name="friction",
            unit="1",
            null=FRICTION,
            low=0.002,
            high=FRICTION,
            step=5e-2,
            link="factor",
            sign=-1,
            doubt=0.045,
        ),
    ),
    change=_change,
    family="transient",
    feigns=FEIGNS,
    confusable_with=("weak_motor", "motor_lag"),
    twins=("weak_motor",),
    as_twin=_as_twin,
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps",
    starts=_starts,
)

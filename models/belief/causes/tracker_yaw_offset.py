"""The tracker's markers are mounted rotated: measured yaw is not the way the robot drives."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return replace(motion, yaw_offset=motion.yaw_offset + float(values[0]))


CAUSE = Cause(
    name="tracker_yaw_offset",
    meaning="the tracker's markers are mounted rotated about the vertical",
    plain="{Whose} marker is turned {angle:counter-clockwise/clockwise}. Mount it straight.",
    parameters=(
        Parameter(
            name="angle",
            unit="rad",
            null=0.0,
            low=-3.2,
            high=3.2,
            step=2e-3,
            doubt=0.03,
        ),
    ),
    change=_change,
    geometric=True,
    confusable_with=("wheel_radius_mismatch", "ir_rotation"),
    experiment="straights",
)

"""One wheel is larger than the other: straight commands give arcs."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    ratio = float(values[0])
    left, right = motion.drive.wheel_radius
    share = 2.0 / (1.0 + ratio)  # the mean radius is kept
    radius = (left * share, right * share * ratio)
    return replace(motion, drive=replace(motion.drive, wheel_radius=radius))


CAUSE = Cause(
    name="wheel_radius_mismatch",
    meaning="the two wheels differ in radius: the robot bends away from the larger one",
    plain="{Whose} right wheel is {ratio:larger/smaller} than its left. Measure both.",
    parameters=(
        Parameter(
            name="ratio", unit="right/left", null=1.0, low=0.5, high=2.0, step=1e-3, doubt=0.03
        ),
    ),
    change=_change,
    geometric=True,
    confusable_with=("tracker_yaw_offset", "wheel_separation"),
    experiment="straights",
)

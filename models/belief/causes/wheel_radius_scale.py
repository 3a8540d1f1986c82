"""Both wheels are larger or smaller than believed: every motion is scaled."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    """The motion with the radii of both wheels scaled."""
    scale = float(values[0])
    left, right = motion.drive.wheel_radius
    drive = replace(motion.drive, wheel_radius=(left * scale, right * scale))
    return replace(motion, drive=drive)


CAUSE = Cause(
    name="wheel_radius_scale",
    meaning="both wheels are larger or smaller than the model has them, or all speeds are scaled",
    plain="{Whose} wheels are {scale:larger/smaller} than in the model, or all its speeds are "
    "scaled. Measure their diameter.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.3, high=3.0, step=1e-3, link="factor"),
    ),
    change=change,
    where="differential",
    geometric=True,
    confusable_with=("speed_droop", "motor_saturation", "motor_dead_zone", "wheel_separation"),
    experiment="straights",
)

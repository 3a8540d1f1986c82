"""The wheels turn faster or slower than they are told to: what the controller takes for a speed."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion
from realitygap.models.log.schema import ENCODERS


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    gain = tuple(values.tolist())
    radius, turned = motion.drive.wheel_radius, motion.wheel_gain
    return replace(
        motion,
        drive=replace(motion.drive, wheel_radius=(radius[0] * gain[0], radius[1] * gain[1])),
        wheel_gain=(turned[0] * gain[0], turned[1] * gain[1]),
    )


CAUSE = Cause(
    name="motor_gain",
    meaning="the wheels turn at another speed than they are told to, in proportion",
    plain="{Whose} left wheel turns at {left:%} of the speed that it is told, the right at "
    "{right:%}. Calibrate the motors' controller.",
    parameters=tuple(
        Parameter(name=side, unit="1", null=1.0, low=0.2, high=3.0, step=1e-3, link="factor")
        for side in ("left", "right")
    ),
    change=_change,
    columns=ENCODERS,
    where="unmeasured",
    confusable_with=("wheel_radius_scale", "wheel_radius_mismatch"),
    experiment="straights",
)

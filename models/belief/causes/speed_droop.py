"""The motors slow down as time passes."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    rate = motion.drive.droop_rate + float(values[0])
    return replace(motion, drive=replace(motion.drive, droop_rate=rate))


CAUSE = Cause(
    name="speed_droop",
    meaning="the motors lose speed as time passes, as on a battery that empties",
    plain="{Whose} motors lose {rate} of their speed. Charge the battery, or replace it.",
    parameters=(
        Parameter(name="rate", unit="1/s", null=0.0, low=-0.01, high=0.05, step=1e-5, sign=1),
    ),
    change=_change,
    confusable_with=("wheel_radius_scale",),
    experiment="straights",
)

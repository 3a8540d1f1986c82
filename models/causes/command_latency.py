"""Commands reach the motors late."""

from __future__ import annotations

from dataclasses import replace

from embedded_sim.model import FloatArray
from models.causes.cause import Cause, Parameter
from models.causes.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    latency = max(0.0, motion.drive.latency + float(values[0]))
    return replace(motion, drive=replace(motion.drive, latency=latency))


CAUSE = Cause(
    name="command_latency",
    meaning="commands reach the motors later than the model believes",
    parameters=(Parameter(name="seconds", unit="s", null=0.0, low=-0.1, high=1.0, step=1e-3),),
    change=_change,
    family="transient",
    confusable_with=("motor_lag", "clock_offset"),
    twins=("clock_offset",),
    separated_by=("wheel_left", "wheel_right"),
    experiment="steps of speed with the sensors or encoders logged",
)

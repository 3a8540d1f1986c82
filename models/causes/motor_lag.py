"""The motors approach a commanded speed gradually."""

from __future__ import annotations

from dataclasses import replace

from embedded_sim.model import FloatArray
from models.causes.cause import Cause, Parameter
from models.causes.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    constant = max(0.0, motion.drive.time_constant + float(values[0]))
    return replace(motion, drive=replace(motion.drive, time_constant=constant))


CAUSE = Cause(
    name="motor_lag",
    meaning="the motors answer as a first-order lag: speed approaches the command gradually",
    parameters=(
        Parameter(name="time_constant", unit="s", null=0.0, low=-0.1, high=1.0, step=1e-3),
    ),
    change=_change,
    confusable_with=("command_latency", "weak_motor", "low_friction"),
    experiment="steps of speed",
)

"""Where a wheel would be too fast, the robot keeps its turn rate and gives up speed."""

from __future__ import annotations

import math
from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.causes.motor_saturation import FASTEST, starts
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    limit = min(motion.drive.turn_first, float(values[0]))
    return replace(motion, drive=replace(motion.drive, turn_first=limit))


CAUSE = Cause(
    name="turn_first",
    meaning="where a wheel would be too fast, the robot keeps its turn rate and gives up speed",
    plain="{Whose} controllers let no wheel turn faster than {limit}: they keep the turn rate and "
    "give up speed. Command less, or raise the limit in the firmware.",
    parameters=(
        Parameter(name="limit", unit="rad/s", null=math.inf, low=1e-3, high=FASTEST, step=2e-2),
    ),
    change=_change,
    confusable_with=("motor_saturation", "wheel_radius_scale"),
    experiment="figure-eight",
    starts=starts,
)

"""The tracker sees a point that is not the middle of the axle."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    lever = (motion.lever[0] + float(values[0]), motion.lever[1] + float(values[1]))
    return replace(motion, lever=lever)


CAUSE = Cause(
    name="tracker_offset",
    meaning="the tracker's markers are mounted off the middle of the axle",
    plain="{Whose} marker sits {x:ahead/behind} and {y:to the left/to the right} of the axle's "
    "middle. Mount it there.",
    parameters=(
        Parameter(
            name="x",
            unit="m",
            null=0.0,
            low=-0.5,
            high=0.5,
            step=5e-4,
            doubt=0.03,
        ),
        Parameter(
            name="y",
            unit="m",
            null=0.0,
            low=-0.5,
            high=0.5,
            step=5e-4,
            doubt=0.03,
        ),
    ),
    change=_change,
    geometric=True,
    confusable_with=("wheel_separation",),
    experiment="spins",
)

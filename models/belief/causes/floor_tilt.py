"""The floor is not level. Known, but wheels that hold their speed hide it."""

from __future__ import annotations

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def _change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    return motion


CAUSE = Cause(
    name="floor_tilt",
    meaning="the floor is not level; wheels that hold their speed hide it, so it is never named",
    plain="The floor slopes by {slope}. Level it.",
    parameters=(
        Parameter(name="slope", unit="rad", null=0.0, low=0.0, high=0.3, step=1e-2),
        Parameter(name="direction", unit="rad", null=0.0, low=-3.2, high=3.2, step=0.1),
    ),
    change=_change,
    confusable_with=("low_friction",),
    experiment="straights",
    identifiable=False,
)

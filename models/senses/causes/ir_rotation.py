"""A ring of sensors mounted at an angle."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.cause import Parameter
from realitygap.models.senses.cause import PS, Belief, SenseCause

ELSEWHERE = 2e-3
"""rad that robots seem turned by whose lamp stands a few centimetres higher, or that circle.
Measured by injecting such lamps into the rigid-body world, and in sound robots that circle
there."""


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, rotation=belief.senses.rotation + float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="ir_rotation",
    meaning="the ring of infrared and light sensors is turned on the body",
    parameters=(
        Parameter(
            name="angle",
            unit="rad",
            null=0.0,
            low=-3.1,
            high=3.1,
            step=0.01,
            elsewhere=ELSEWHERE,
        ),
    ),
    sense=_sense,
    kind="both",
    columns=PS,
    confusable_with=("tracker_yaw_offset",),
    experiment="tour",
)

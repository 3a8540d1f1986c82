"""A ring of sensors mounted at an angle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import PS, Belief, SenseCause

ELSEWHERE = 2e-3
"""rad that robots seem turned by whose lamp stands a few centimetres higher, or that circle.
Measured by injecting such lamps into the rigid-body world, and in sound robots that circle
there."""

TURN = 0.1
"""rad that the ring is first taken to be turned by: a reading bends within a few degrees, so that a
small turn says little of a large one."""


def _starts(commands: FloatArray) -> list[FloatArray]:
    return [np.array([TURN]), np.array([-TURN])]


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, rotation=belief.senses.rotation + float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="ir_rotation",
    meaning="the ring of infrared and light sensors is turned on the body",
    plain="{Whose} ring of sensors is turned {angle:counter-clockwise/clockwise}. Mount it "
    "straight.",
    parameters=(
        Parameter(
            name="angle",
            unit="rad",
            null=0.0,
            low=-3.1,
            high=3.1,
            step=0.03,
            unsure=ELSEWHERE,
        ),
    ),
    sense=_sense,
    kind="both",
    columns=PS,
    confusable_with=("tracker_yaw_offset",),
    experiment="tour",
    starts=_starts,
)

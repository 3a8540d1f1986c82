"""The wheels stand further apart or nearer than believed: only turns are scaled."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion


def change(motion: Motion, values: FloatArray, variant: str) -> Motion:
    """The motion with the axle scaled."""
    return replace(motion, drive=replace(motion.drive, axle=motion.drive.axle * float(values[0])))


CAUSE = Cause(
    name="wheel_separation",
    meaning="the wheels touch the floor further apart or nearer than the model has them",
    plain="{Whose} wheels touch the floor {scale:further apart/nearer together} than in the "
    "model. Measure between the tyres.",
    parameters=(
        Parameter(
            name="scale",
            unit="1",
            null=1.0,
            low=0.3,
            high=3.0,
            step=1e-3,
            link="factor",
            doubt=0.04,
        ),
    ),
    change=change,
    where="differential",
    geometric=True,
    confusable_with=("wheel_radius_scale", "wheel_radius_mismatch"),
    experiment="spins",
)

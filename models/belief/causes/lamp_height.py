"""A lamp mounted higher or lower than the captured one."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause

LAMP_HEIGHT = PointModel().lamp_height
"""m, of the captured lamp."""


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    believed = belief.senses.lamp_height
    moved = 0.0 if believed is None else believed - LAMP_HEIGHT
    return replace(belief, senses=replace(belief.senses, lamp_height=float(values[0]) + moved))


CAUSE = SenseCause(
    name="lamp_height",
    meaning="the lamp is higher or lower than the captured one",
    plain="The lamp hangs {height:higher/lower} than when the sensors were captured. Measure its "
    "height.",
    parameters=(
        Parameter(name="height", unit="m", null=LAMP_HEIGHT, low=0.0, high=5.0, step=0.001),
    ),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_intensity", "light_falloff"),
    experiment="tour",
)

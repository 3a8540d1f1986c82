"""Light that does not fall off with the square of the distance."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause

SQUARE = 2.0
"""Exponent of the captured law."""


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    exponent = belief.senses.light_exponent * float(values[0]) / SQUARE
    return replace(belief, senses=replace(belief.senses, light_exponent=exponent))


CAUSE = SenseCause(
    name="light_falloff",
    meaning="the light falls off with another power of distance",
    plain="The light falls off with distance to the power {exponent}. Look for reflections and "
    "for other lamps.",
    parameters=(Parameter(name="exponent", unit="1", null=SQUARE, low=0.0, high=6.0, step=0.01),),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_height", "lamp_intensity", "light_gamma"),
    experiment="tour",
)

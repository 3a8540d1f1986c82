"""Light sensors that do not answer linearly."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gamma = belief.senses.light_gamma * float(values[0])
    return replace(belief, senses=replace(belief.senses, light_gamma=gamma))


CAUSE = SenseCause(
    name="light_gamma",
    meaning="the light sensors answer to light with another response curve",
    plain="{Whose} light sensors answer with the power {exponent} of what they were captured "
    "with. Capture them again.",
    parameters=(Parameter(name="exponent", unit="1", null=1.0, low=0.2, high=5.0, step=0.005),),
    sense=_sense,
    kind="ls",
    columns=(*LS, "case"),
    confusable_with=("light_falloff", "lamp_height", "ambient_light"),
    experiment="tour",
)

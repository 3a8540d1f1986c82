"""A room brighter than when the sensors were captured."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    level = belief.senses.ambient_light + float(values[0])
    return replace(belief, senses=replace(belief.senses, ambient_light=level))


CAUSE = SenseCause(
    name="ambient_light",
    meaning="the room is brighter or darker than when the sensors were captured",
    plain="The room is {level:brighter/darker} than when the light sensors were captured. Shade "
    "its windows and lamps.",
    parameters=(
        Parameter(
            name="level",
            unit="share of the reading at 0.5 m",
            null=0.0,
            low=-0.6,
            high=10.0,
            step=0.005,
            doubt=0.08,
        ),
    ),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("second_lamp",),
    experiment="dark-tour",
)

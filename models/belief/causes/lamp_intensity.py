"""A lamp brighter or dimmer than the captured one."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, lamp_intensity=belief.senses.lamp_intensity * float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="lamp_intensity",
    meaning="the lamp is brighter or dimmer than the captured one",
    plain="The lamp is {scale:brighter/dimmer} than when the sensors were captured. Check its "
    "supply and its bulb.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.01, high=100.0, step=0.01, link="factor"),
    ),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_height", "light_falloff", "lamp_decay"),
    experiment="tour",
)

"""A lamp that dims."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import LS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, lamp_decay=belief.senses.lamp_decay + float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="lamp_decay",
    meaning="the lamp dims as time goes by",
    plain="The lamp dims: it loses {rate}. Check its supply, or replace it.",
    parameters=(Parameter(name="rate", unit="1/s", null=0.0, low=-1e-4, high=0.1, step=0.0002),),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("lamp_intensity",),
    experiment="tour",
)

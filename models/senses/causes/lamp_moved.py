"""A lamp that does not stand where it should."""

from __future__ import annotations

from dataclasses import replace

from embedded_sim.model import FloatArray
from models.causes.cause import Parameter
from models.senses.cause import LS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    x, y = belief.senses.lamp_shift
    shift = (x + float(values[0]), y + float(values[1]))
    return replace(belief, senses=replace(belief.senses, lamp_shift=shift))


CAUSE = SenseCause(
    name="lamp_moved",
    meaning="the lamp stands elsewhere than believed",
    parameters=(
        Parameter(name="x", unit="m", null=0.0, low=-3.0, high=3.0, step=0.002),
        Parameter(name="y", unit="m", null=0.0, low=-3.0, high=3.0, step=0.002),
    ),
    sense=_sense,
    kind="ls",
    place=True,
    columns=(*LS, "case"),
    confusable_with=("second_lamp",),
    experiment="tour",
)

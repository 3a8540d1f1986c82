"""Infrared sensors that see more or less than the captured ones."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import PS, SENSORS_OR_ALL, Belief, SenseCause, chosen


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gain = list(belief.senses.ps_gain)
    for k in chosen(variant):
        gain[k] *= float(values[0])
    return replace(belief, senses=replace(belief.senses, ps_gain=tuple(gain)))


CAUSE = SenseCause(
    name="ir_gain",
    meaning="infrared emitter or receiver of another gain",
    plain="{Whose} infrared {which} reads {scale:more/less} than the captured one. Clean it, and "
    "check its supply.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.02, high=10.0, step=0.01, link="factor"),
    ),
    sense=_sense,
    kind="ps",
    variants=SENSORS_OR_ALL,
    word="sensor",
    columns=PS,
    confusable_with=("wall_albedo",),
    experiment="face-to-face",
)

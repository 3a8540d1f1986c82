"""A wall that reflects more or less infrared light."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import PS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, wall_albedo=belief.senses.wall_albedo * float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="wall_albedo",
    meaning="the wall reflects more or less infrared than the captured one",
    plain="The wall reflects {scale:more/less} infrared than the captured one. Measure its "
    "paint, or capture it again.",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.02, high=10.0, step=0.01, link="factor"),
    ),
    sense=_sense,
    kind="ps",
    place=True,
    columns=PS,
    confusable_with=("ir_gain",),
    experiment="face-to-face",
)

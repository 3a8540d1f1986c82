"""Infrared sensors noisier than the captured ones."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.cause import Parameter
from realitygap.models.senses.cause import PS, Belief, SenseCause


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, ps_noise=belief.senses.ps_noise * float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="ir_noise",
    meaning="the infrared readings are noisier, or less noisy, than the captured ones",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.01, high=100.0, step=0.01, link="factor"),
    ),
    sense=_sense,
    kind="noise",
    columns=PS,
    experiment="face-to-face",
)

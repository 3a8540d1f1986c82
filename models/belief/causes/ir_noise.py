"""Infrared sensors noisier than the captured ones."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import PS, Belief, SenseCause

FEIGNS = {"ir_offset": 1.0, "infrared/counts/always": 1.0}
"""counts: readings are whole numbers not below 0, so that more noise moves their mean by up to
one."""
DOUBT = 0.1
"""Of the logarithm of the scale: what windows have of their own takes a little of loud noise for
its own. Measured by simulated readings: 2.0 was told as 1.9."""


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    senses = replace(belief.senses, ps_noise=belief.senses.ps_noise * float(values[0]))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="ir_noise",
    meaning="the infrared readings are noisier, or less noisy, than the captured ones",
    plain="{Whose} infrared readings scatter {scale:more/less} than the captured ones. Look for "
    "flickering lamps and a weak supply.",
    parameters=(
        Parameter(
            name="scale",
            unit="1",
            null=1.0,
            low=0.01,
            high=100.0,
            step=0.01,
            link="factor",
            doubt=DOUBT,
        ),
    ),
    sense=_sense,
    kind="noise",
    columns=PS,
    experiment="face-to-face",
    feigns=FEIGNS,
)

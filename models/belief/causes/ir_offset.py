"""Infrared in the room that every sensor adds to its reading."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import PS, Belief, SenseCause

ELSEWHERE = 0.15
"""counts that a wall of another albedo or a turned ring makes of noise cut off at zero. Measured by
injecting these two into the rigid-body world: a quarter and a half were seen."""


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    offset = tuple(one + float(values[0]) for one in belief.senses.ps_offset)
    return replace(belief, senses=replace(belief.senses, ps_offset=offset))


CAUSE = SenseCause(
    name="ir_offset",
    meaning="infrared in the room adds to every infrared reading",
    plain="{Whose} infrared sensors read {counts:more/less} everywhere. Look for sunlight and "
    "warm lamps in the room.",
    parameters=(
        Parameter(
            name="counts",
            unit="counts",
            null=0.0,
            low=-100.0,
            high=4095.0,
            step=0.5,
            unsure=ELSEWHERE,
        ),
    ),
    sense=_sense,
    kind="ps",
    columns=PS,
    experiment="alone",
)

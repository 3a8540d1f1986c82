"""An infrared sensor that reads nothing."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import ONE_SENSOR, PS, Belief, SenseCause, chosen


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gain, offset = list(belief.senses.ps_gain), list(belief.senses.ps_offset)
    for k in chosen(variant):
        gain[k] = offset[k] = 0.0
    senses = replace(belief.senses, ps_gain=tuple(gain), ps_offset=tuple(offset))
    return replace(belief, senses=senses)


CAUSE = SenseCause(
    name="ir_dead_sensor",
    meaning="an infrared sensor is dead: it reads nothing, whatever is in front of it",
    plain="{Whose} infrared {which} reads nothing, whatever is in front of it. Check its cable, "
    "or replace it.",
    parameters=(),
    sense=_sense,
    kind="ps",
    smooth=False,
    variants=ONE_SENSOR,
    word="sensor",
    columns=PS,
    experiment="tour",
)

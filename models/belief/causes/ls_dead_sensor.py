"""A light sensor that is covered."""

from __future__ import annotations

from dataclasses import replace

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import LS, ONE_SENSOR, Belief, SenseCause, chosen


def _sense(belief: Belief, values: FloatArray, variant: str) -> Belief:
    gain = list(belief.senses.ls_gain)
    for k in chosen(variant):
        gain[k] = 0.0
    return replace(belief, senses=replace(belief.senses, ls_gain=tuple(gain)))


CAUSE = SenseCause(
    name="ls_dead_sensor",
    meaning="a light sensor is covered or dead: it reads dark whatever light falls on it",
    plain="{Whose} light {which} reads dark, whatever light falls on it. Uncover it, or replace "
    "it.",
    parameters=(),
    sense=_sense,
    kind="ls",
    smooth=False,
    variants=ONE_SENSOR,
    word="sensor",
    columns=LS,
    experiment="tour",
)

"""Infrared sensors noisier than the nominal ones."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Robots, Value, number, scale
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.ir_noise[robots] *= number(values, "scale")


EFFECT = Effect(
    name="ir_noise",
    kind="infrared",
    physics="the channel's relative noise and its noise floor are scaled",
    parameters={"scale": scale(0.0, 100.0)},
    apply=_apply,
)

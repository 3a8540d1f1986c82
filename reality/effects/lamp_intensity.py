"""A lamp brighter or dimmer than the one captured."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Robots, Value, number, scale
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.lamp.scale *= number(values, "scale")


EFFECT = Effect(
    name="lamp_intensity",
    kind="light",
    physics="the lamp has another power",
    parameters={"scale": scale(0.0, 100.0)},
    apply=_apply,
    per_robot=False,
)

"""A wall that reflects more or less infrared light."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Robots, Value, number, scale
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.wall_reflectance *= number(values, "scale")


EFFECT = Effect(
    name="wall_albedo",
    kind="infrared",
    physics="the wall, and not the robots, has another reflectance in the infrared",
    parameters={"scale": scale(0.0, 10.0)},
    apply=_apply,
    per_robot=False,
)

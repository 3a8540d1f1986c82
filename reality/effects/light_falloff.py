"""Light that does not fall off with the square of the distance."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.lamp.exponent = number(values, "exponent")


EFFECT = Effect(
    name="light_falloff",
    kind="light",
    physics="the field falls off with another power of distance, the same at 1 m",
    parameters={"exponent": Key(low=0.0, high=6.0, null=k.LIGHT_EXPONENT)},
    apply=_apply,
    per_robot=False,
)

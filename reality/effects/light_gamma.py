"""Light sensors that do not answer linearly."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.light_response[robots] = number(values, "exponent")


EFFECT = Effect(
    name="light_gamma",
    kind="light",
    physics="the answer to light is full scale times (light / full scale)^exponent",
    parameters={"exponent": Key(low=0.2, high=5.0, null=1.0)},
    apply=_apply,
)

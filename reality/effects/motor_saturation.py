"""A motor that cannot turn as fast as it is told."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import (
    WHEEL,
    Effect,
    Key,
    Robots,
    Value,
    number,
    put,
    wheels,
)
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    put(hardware.speed_limit, robots, wheels(values), number(values, "limit"))


EFFECT = Effect(
    name="motor_saturation",
    kind="motion",
    physics="a motor cannot turn faster than this",
    parameters={"limit": Key(unit="rad/s", low=0.0, high=100.0), "wheel": WHEEL},
    apply=_apply,
)

"""A motor that does not answer slow commands."""

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
    put(hardware.dead_zone, robots, wheels(values), number(values, "threshold"))


EFFECT = Effect(
    name="motor_dead_zone",
    kind="motion",
    physics="a motor does not turn at commands slower than this",
    parameters={
        "threshold": Key(unit="rad/s", low=0.0, high=100.0, null=0.0),
        "wheel": WHEEL,
    },
    apply=_apply,
)

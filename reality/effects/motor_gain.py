"""Motors whose controller turns the wheels faster or slower than told, in proportion."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.motor_gain[robots] = (number(values, "left"), number(values, "right"))


EFFECT = Effect(
    name="motor_gain",
    kind="motion",
    physics="a motor is asked for a share of the speed that its wheel is told",
    parameters={side: Key(unit="1", low=0.2, high=3.0, null=1.0) for side in ("left", "right")},
    apply=_apply,
)

"""Motors that follow their command with a first-order lag."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.motor_lag[robots] = number(values, "time_constant")


EFFECT = Effect(
    name="motor_lag",
    kind="motion",
    physics="a motor approaches its commanded speed exponentially",
    parameters={"time_constant": Key(unit="s", low=0.0, high=2.0, null=0.0)},
    apply=_apply,
)

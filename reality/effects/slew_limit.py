"""A controller that ramps the wheels' speeds."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.slew_limit[robots] = number(values, "rate")


EFFECT = Effect(
    name="slew_limit",
    kind="motion",
    physics="the speed that a motor is asked for changes at most at this rate",
    parameters={"rate": Key(unit="rad/s^2", low=1e-3, high=1e6)},
    apply=_apply,
)

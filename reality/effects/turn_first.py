"""A controller that keeps the turn rate and gives up speed where a wheel would be too fast."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.turn_first[robots] = number(values, "limit")


EFFECT = Effect(
    name="turn_first",
    kind="motion",
    physics="where a wheel would be faster than this, speed gives way and the turn rate is kept",
    parameters={"limit": Key(unit="rad/s", low=0.0, high=100.0)},
    apply=_apply,
)

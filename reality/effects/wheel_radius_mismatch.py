"""Two wheels of different radius."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    ratio = number(values, "ratio")
    mean = hardware.wheel_radius[robots].mean(axis=1)
    hardware.wheel_radius[robots, 0] = 2.0 * mean / (1.0 + ratio)
    hardware.wheel_radius[robots, 1] = 2.0 * mean * ratio / (1.0 + ratio)


EFFECT = Effect(
    name="wheel_radius_mismatch",
    kind="motion",
    physics="the body has two wheels of different radius, their mean kept",
    parameters={"ratio": Key(unit="right/left", low=0.5, high=2.0, null=1.0)},
    apply=_apply,
)

"""A tracker whose poses are late against the robot's own clock."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.clock_delay[robots] = number(values, "seconds")


EFFECT = Effect(
    name="clock_offset",
    kind="motion",
    physics="the tracker's clock is late: a pose is from this long ago",
    parameters={"seconds": Key(unit="s", low=0.0, high=2.0, null=0.0)},
    apply=_apply,
)

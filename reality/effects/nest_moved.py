"""A nest that is not where the simulator has it."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.nest[robots, 0] += number(values, "x")
    hardware.nest[robots, 1] += number(values, "y")


EFFECT = Effect(
    name="nest_moved",
    kind="task",
    physics="the virtual sensor says nest at a displaced place",
    parameters={
        "x": Key(unit="m", low=-2.0, high=2.0, null=0.0, default=0.0),
        "y": Key(unit="m", low=-2.0, high=2.0, null=0.0, default=0.0),
    },
    apply=_apply,
)

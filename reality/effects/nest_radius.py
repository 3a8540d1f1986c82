"""A nest larger or smaller than the simulator has it."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Robots, Value, number, scale
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.nest[robots, 2] *= number(values, "scale")


EFFECT = Effect(
    name="nest_radius",
    kind="task",
    physics="the virtual sensor says nest within another radius",
    parameters={"scale": scale(0.0, 5.0)},
    apply=_apply,
)

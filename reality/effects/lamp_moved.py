"""A lamp that does not stand where it should."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.lamp.x += number(values, "x")
    hardware.lamp.y += number(values, "y")


EFFECT = Effect(
    name="lamp_moved",
    kind="light",
    physics="the lamp is displaced from where the case has it",
    parameters={
        "x": Key(unit="m", low=-3.0, high=3.0, null=0.0, default=0.0),
        "y": Key(unit="m", low=-3.0, high=3.0, null=0.0, default=0.0),
    },
    apply=_apply,
    per_robot=False,
)

"""A lamp mounted higher or lower."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.lamp.height = number(values, "height")


EFFECT = Effect(
    name="lamp_height",
    kind="light",
    physics="the lamp is moved up or down",
    parameters={"height": Key(unit="m", low=0.0, high=5.0, null=k.LAMP_HEIGHT)},
    apply=_apply,
    per_robot=False,
)

"""Wheels that grip less."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.wheel_friction[robots] = number(values, "friction")


EFFECT = Effect(
    name="low_friction",
    kind="motion",
    physics="the wheels have another coefficient of friction",
    parameters={"friction": Key(low=0.0, high=5.0, null=k.WHEEL_FRICTION)},
    apply=_apply,
)

"""Motors with less torque than the e-puck's."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.motor_torque[robots] = number(values, "torque")


EFFECT = Effect(
    name="weak_motor",
    kind="motion",
    physics="the torque that a motor can give is limited",
    parameters={"torque": Key(unit="N m", low=0.0, high=0.1, null=k.MOTOR_TORQUE)},
    apply=_apply,
)

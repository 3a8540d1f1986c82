"""A light sensor that is covered."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import SENSOR, Effect, Robots, Value, put, sensors
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    put(hardware.light_gain, robots, sensors(values), 0.0)


EFFECT = Effect(
    name="ls_dead_sensor",
    kind="light",
    physics="the sensor is covered and reads dark",
    parameters={"sensor": SENSOR},
    apply=_apply,
)

"""An infrared sensor that reads nothing."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import SENSOR, Effect, Robots, Value, put, sensors
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    put(hardware.ir_alive, robots, sensors(values), 0.0)


EFFECT = Effect(
    name="ir_dead_sensor",
    kind="infrared",
    physics="the sensor's channel reads 0",
    parameters={"sensor": SENSOR},
    apply=_apply,
)

"""An infrared sensor that reads nothing."""

from __future__ import annotations

from collections.abc import Mapping

from embedded_sim import SENSORS
from reality.effects.effect import Effect, Parameter, Robots, Value, number
from reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.ir_alive[robots, int(number(values, "sensor"))] = 0.0


EFFECT = Effect(
    name="ir_dead_sensor",
    physics="the sensor's channel reads 0",
    parameters={"sensor": Parameter(words=tuple(str(i) for i in range(SENSORS)))},
    apply=_apply,
)

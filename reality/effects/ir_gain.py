"""Infrared sensors that see more or less than the nominal ones."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import (
    SENSOR_OR_ALL,
    Effect,
    Robots,
    Value,
    multiply,
    number,
    scale,
    sensors,
)
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    multiply(hardware.ir_amplitude, robots, sensors(values), number(values, "scale"))


EFFECT = Effect(
    name="ir_gain",
    kind="infrared",
    physics="emitter and receiver of a sensor have another gain",
    parameters={"scale": scale(0.0, 10.0), "sensor": SENSOR_OR_ALL},
    apply=_apply,
)

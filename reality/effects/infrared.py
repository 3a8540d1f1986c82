"""The infrared sensors, and the wall that they see."""

from __future__ import annotations

import math

from realitygap.reality.effects.effect import (
    SENSOR,
    SENSOR_OR_ALL,
    Key,
    Robots,
    Values,
    effect,
    number,
    scale,
    sensors,
)
from realitygap.reality.hardware import Hardware


@effect(kind="infrared", physics="the sensor's channel reads 0", sensor=SENSOR)
def ir_dead_sensor(hardware: Hardware, robots: Robots, values: Values) -> None:
    """An infrared sensor that reads nothing."""
    hardware.ir_alive[robots, sensors(values)] = 0.0


@effect(
    kind="infrared",
    physics="emitter and receiver of a sensor have another gain",
    scale=scale(0.0, 10.0),
    sensor=SENSOR_OR_ALL,
)
def ir_gain(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Infrared sensors that see more or less than the nominal ones."""
    hardware.ir_amplitude[robots, sensors(values)] *= number(values, "scale")


@effect(
    kind="infrared",
    physics="the channel's relative noise and its noise floor are scaled",
    scale=scale(0.0, 100.0),
)
def ir_noise(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Infrared sensors noisier than the nominal ones."""
    hardware.ir_noise[robots] *= number(values, "scale")


@effect(
    kind="infrared",
    physics="ambient infrared adds to every reading",
    counts=Key(unit="counts", low=-4095.0, high=4095.0, null=0.0),
)
def ir_offset(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Infrared in the room that every sensor adds to its reading."""
    hardware.ir_offset[robots] = number(values, "counts")


@effect(
    kind="infrared",
    physics="the ring of infrared and light sensors is turned on the body, counter-clockwise",
    angle=Key(unit="rad", low=-math.pi, high=math.pi, null=0.0),
)
def ir_rotation(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A ring of sensors mounted at an angle."""
    hardware.sensor_angles[robots] += number(values, "angle")


@effect(
    kind="infrared",
    physics="the wall, and not the robots, has another reflectance in the infrared",
    per_robot=False,
    scale=scale(0.0, 10.0),
)
def wall_albedo(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A wall that reflects more or less infrared light."""
    hardware.wall_reflectance *= number(values, "scale")

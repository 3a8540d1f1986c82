"""Wheels and the floor under them."""

from __future__ import annotations

import math

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import Key, Robots, Values, effect, number, scale
from realitygap.reality.hardware import Hardware


@effect(
    kind="motion",
    physics="gravity is turned against the floor: downhill is the direction given",
    per_robot=False,
    slope=Key(unit="rad", low=0.0, high=0.35, null=0.0),
    direction=Key(unit="rad", low=-math.pi, high=math.pi, default=0.0),
)
def floor_tilt(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A floor that is not level."""
    slope, direction = number(values, "slope"), number(values, "direction")
    along = k.GRAVITY * math.sin(slope)
    hardware.gravity = (
        along * math.cos(direction),
        along * math.sin(direction),
        -k.GRAVITY * math.cos(slope),
    )


@effect(
    kind="motion",
    physics="the wheels have another coefficient of friction",
    friction=Key(low=0.0, high=5.0, null=k.WHEEL_FRICTION),
)
def low_friction(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Wheels that grip less."""
    hardware.wheel_friction[robots] = number(values, "friction")


@effect(
    kind="motion",
    physics="the body has two wheels of different radius, their mean kept",
    ratio=Key(unit="right/left", low=0.5, high=2.0, null=1.0),
)
def wheel_radius_mismatch(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Two wheels of different radius."""
    ratio = number(values, "ratio")
    mean = hardware.wheel_radius[robots].mean(axis=1)
    hardware.wheel_radius[robots, 0] = 2.0 * mean / (1.0 + ratio)
    hardware.wheel_radius[robots, 1] = 2.0 * mean * ratio / (1.0 + ratio)


@effect(
    kind="motion", physics="both of the body's wheels have another radius", scale=scale(0.5, 1.5)
)
def wheel_radius_scale(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Both wheels larger or smaller than the data sheet says."""
    hardware.wheel_radius[robots] *= number(values, "scale")


@effect(
    kind="motion",
    physics="the wheels' joints sit nearer together or wider apart",
    scale=scale(0.5, 1.5),
)
def wheel_separation(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Wheels nearer together or wider apart than the data sheet says."""
    hardware.axle[robots] *= number(values, "scale")

"""The tracker, and what its virtual sensor says of the nest."""

from __future__ import annotations

import math

from realitygap.reality.effects.effect import Key, Robots, Values, effect, number, scale
from realitygap.reality.hardware import Hardware


@effect(
    kind="motion",
    physics="the tracker's clock is late: a pose is from this long ago",
    seconds=Key(unit="s", low=0.0, high=2.0, null=0.0),
)
def clock_offset(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A tracker whose poses are late against the robot's own clock."""
    hardware.clock_delay[robots] = number(values, "seconds")


@effect(
    kind="task",
    physics="the virtual sensor says nest at a displaced place",
    x=Key(unit="m", low=-2.0, high=2.0, null=0.0, default=0.0),
    y=Key(unit="m", low=-2.0, high=2.0, null=0.0, default=0.0),
)
def nest_moved(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A nest that is not where the simulator has it."""
    hardware.nest[robots, 0] += number(values, "x")
    hardware.nest[robots, 1] += number(values, "y")


@effect(
    kind="task", physics="the virtual sensor says nest within another radius", scale=scale(0.0, 5.0)
)
def nest_radius(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A nest larger or smaller than the simulator has it."""
    hardware.nest[robots, 2] *= number(values, "scale")


@effect(
    kind="motion",
    physics="the tracker's markers sit ahead (x) or to the left (y) of the axle's middle",
    x=Key(unit="m", low=-0.1, high=0.1, null=0.0, default=0.0),
    y=Key(unit="m", low=-0.1, high=0.1, null=0.0, default=0.0),
)
def tracker_offset(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Tracker markers mounted off the middle of the axle."""
    hardware.markers[robots, 0] = number(values, "x")
    hardware.markers[robots, 1] = number(values, "y")


@effect(
    kind="motion",
    physics="the tracker's markers are turned against the body, counter-clockwise",
    angle=Key(unit="rad", low=-math.pi, high=math.pi, null=0.0),
)
def tracker_yaw_offset(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Tracker markers mounted at an angle."""
    hardware.markers[robots, 2] = number(values, "angle")

"""Motors, and what stands between a command and them."""

from __future__ import annotations

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import (
    WHEEL,
    Key,
    Robots,
    Values,
    effect,
    number,
    scale,
    wheels,
)
from realitygap.reality.hardware import Hardware


@effect(
    kind="motion",
    physics="commands wait in a queue before the motors",
    seconds=Key(unit="s", low=0.0, high=2.0, null=0.0),
)
def command_latency(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Commands that reach the motors late."""
    hardware.command_delay[robots] = number(values, "seconds")


@effect(
    kind="motion",
    physics="a motor does not turn at commands slower than this",
    threshold=Key(unit="rad/s", low=0.0, high=100.0, null=0.0),
    wheel=WHEEL,
)
def motor_dead_zone(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A motor that does not answer slow commands."""
    hardware.dead_zone[robots, wheels(values)] = number(values, "threshold")


@effect(
    kind="motion",
    physics="a motor is asked for a share of the speed that its wheel is told",
    left=scale(0.2, 3.0),
    right=scale(0.2, 3.0),
)
def motor_gain(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Motors whose controller turns the wheels faster or slower than told, in proportion."""
    hardware.motor_gain[robots] = (number(values, "left"), number(values, "right"))


@effect(
    kind="motion",
    physics="a motor approaches its commanded speed exponentially",
    time_constant=Key(unit="s", low=0.0, high=2.0, null=0.0),
)
def motor_lag(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Motors that follow their command with a first-order lag."""
    hardware.motor_lag[robots] = number(values, "time_constant")


@effect(
    kind="motion",
    physics="a motor cannot turn faster than this",
    limit=Key(unit="rad/s", low=0.0, high=100.0),
    wheel=WHEEL,
)
def motor_saturation(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A motor that cannot turn as fast as it is told."""
    hardware.speed_limit[robots, wheels(values)] = number(values, "limit")


@effect(
    kind="motion",
    physics="the speed that a motor is asked for changes at most at this rate",
    rate=Key(unit="rad/s^2", low=1e-3, high=1e6),
)
def slew_limit(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A controller that ramps the wheels' speeds."""
    hardware.slew_limit[robots] = number(values, "rate")


@effect(
    kind="motion",
    physics="the speed a motor reaches falls linearly with time",
    rate=Key(unit="1/s", low=0.0, high=0.1, null=0.0),
)
def speed_droop(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Motors that slow down as the battery empties."""
    hardware.droop[robots] = number(values, "rate")


@effect(
    kind="motion",
    physics="a motor holds its wheel for this long before it starts or turns the other way",
    seconds=Key(unit="s", low=0.0, high=2.0, null=0.0),
)
def start_delay(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Wheels that stand for a while before they start."""
    hardware.start_delay[robots] = number(values, "seconds")


@effect(
    kind="motion",
    physics="where a wheel would be faster than this, speed gives way and the turn rate is kept",
    limit=Key(unit="rad/s", low=0.0, high=100.0),
)
def turn_first(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A controller that keeps the turn rate and gives up speed where a wheel would be too fast."""
    hardware.turn_first[robots] = number(values, "limit")


@effect(
    kind="motion",
    physics="the torque that a motor can give is limited",
    torque=Key(unit="N m", low=0.0, high=0.1, null=k.MOTOR_TORQUE),
)
def weak_motor(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Motors with less torque than the e-puck's."""
    hardware.motor_torque[robots] = number(values, "torque")

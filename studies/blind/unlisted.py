"""What can be wrong though no catalogue lists it: the diagnosis must say that it is at a loss.

They are physical, each follows a quantity that a log holds, and the battery's menu says which.
They are known to the battery alone: `realitygap run` does not take them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from realitygap.reality import constants as k
from realitygap.reality.effects import Effect, Key
from realitygap.reality.effects.effect import WHEEL, Robots, Values, effect, number, wheels
from realitygap.reality.hardware import FloatArray, Hardware, WheelLaw

SHARE = Key(low=0.0, high=0.9, null=0.0)
REACH = 0.05
"""m over which `shy_robots` feel one another; our choice."""


def _amount(hardware: Hardware, robots: Robots, values: Values) -> FloatArray:
    """(robots, 1) share that each robot loses."""
    amount: FloatArray = np.zeros((hardware.robots, 1))
    amount[robots] = number(values, "share")
    return amount


def _turned_by(hardware: Hardware, law: WheelLaw) -> None:
    """Let wheels turn by a law, on top of those that they turn by already."""
    before = hardware.laws.wheels or (lambda speeds, angles, poses, time: speeds)
    hardware.laws.wheels = lambda speeds, angles, poses, time: law(
        before(speeds, angles, poses, time), angles, poses, time
    )


@effect(
    kind="motion",
    physics="the hub is off the wheel's middle: its speed changes as it turns",
    share=SHARE,
    wheel=WHEEL,
)
def eccentric_wheel(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A wheel whose hub is off its middle."""
    amount: FloatArray = np.zeros((hardware.robots, 2))
    amount[robots, wheels(values)] = number(values, "share")
    _turned_by(
        hardware, lambda speeds, angles, poses, time: speeds * (1.0 + amount * np.cos(angles))
    )


def _slower_where(
    hardware: Hardware, robots: Robots, values: Values, where: Callable[[FloatArray], FloatArray]
) -> None:
    """Wheels of the chosen robots lose a share of speed in proportion to `where` (robots,)."""
    amount = _amount(hardware, robots, values)
    _turned_by(
        hardware,
        lambda speeds, angles, poses, time: speeds * (1.0 - amount * where(poses)[:, None]),
    )


@effect(
    kind="motion",
    physics="wheels turn slower on the left half of the floor",
    per_robot=False,
    share=SHARE,
)
def carpet(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A carpet on half of the floor."""
    _slower_where(hardware, robots, values, lambda poses: (poses[:, 1] > 0.0).astype(float))


def _crowded(poses: FloatArray) -> FloatArray:
    """1 for robots that touch, falling with the gap to the nearest."""
    apart = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    gap = np.maximum(apart.min(axis=1) - 2.0 * k.BODY_RADIUS, 0.0)
    return np.asarray(np.exp(-gap / REACH))


@effect(kind="motion", physics="wheels turn slower near another robot", share=SHARE)
def shy_robots(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Robots that slow down near others."""
    _slower_where(hardware, robots, values, _crowded)


@effect(
    kind="motion",
    physics="the faster a wheel is told to turn, the larger the share it loses",
    share=SHARE,
)
def speed_loss(hardware: Hardware, robots: Robots, values: Values) -> None:
    """Wheels that lose speed where they are fast."""
    amount = _amount(hardware, robots, values)
    _turned_by(
        hardware,
        lambda speeds, angles, poses, time: (
            speeds * (1.0 - amount * np.abs(speeds) / k.WHEEL_SPEED_MAX)
        ),
    )


@effect(
    kind="motion",
    physics="the tracker's lens pulls what is far from the middle inwards",
    per_robot=False,
    share=SHARE,
)
def lens(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A tracker whose lens was not calibrated."""
    share = number(values, "share")

    def bend(poses: FloatArray) -> FloatArray:
        bent = poses.copy()
        squared = (poses[:, :2] ** 2).sum(axis=1, keepdims=True) / k.ARENA_RADIUS**2
        bent[:, :2] *= 1.0 - share * squared
        return bent

    hardware.laws.tracker = bend


@effect(
    kind="infrared",
    physics="sensors that look one way read infrared from outside",
    per_robot=False,
    counts=Key(unit="counts", low=0.0, high=4095.0, null=0.0),
    direction=Key(unit="rad", low=-math.pi, high=math.pi),
)
def low_sun(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A sun that stands low."""
    counts, direction = number(values, "counts"), number(values, "direction")
    hardware.laws.infrared = lambda directions, poses: (
        counts * np.maximum(np.cos(directions - direction), 0.0)
    )


@effect(
    kind="light",
    physics="the lamp's power swings with time",
    per_robot=False,
    share=SHARE,
    period=Key(unit="s", low=0.1, high=1000.0),
)
def flicker(hardware: Hardware, robots: Robots, values: Values) -> None:
    """A lamp that flickers."""
    share, period = number(values, "share"), number(values, "period")
    hardware.laws.lamp = lambda time: 1.0 + share * math.sin(2.0 * math.pi * time / period)


UNLISTED: Mapping[str, Effect] = {
    one.name: one
    for one in (eccentric_wheel, carpet, shy_robots, speed_loss, lens, low_sun, flicker)
}
"""By name."""

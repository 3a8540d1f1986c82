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
from realitygap.reality.effects.effect import WHEEL, Robots, Value, number, wheels
from realitygap.reality.hardware import FloatArray, Hardware
from realitygap.reality.laws import WheelLaw

Apply = Callable[[Hardware, Robots, Mapping[str, Value]], None]

SHARE = Key(low=0.0, high=0.9, null=0.0)
REACH = 0.05
"""m over which `shy_robots` feel one another; our choice."""


def _amount(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> FloatArray:
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


def _eccentric(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    amount: FloatArray = np.zeros((hardware.robots, 2))
    amount[robots, wheels(values)] = number(values, "share")
    _turned_by(
        hardware, lambda speeds, angles, poses, time: speeds * (1.0 + amount * np.cos(angles))
    )


def _slower_where(where: Callable[[FloatArray], FloatArray]) -> Apply:
    """Wheels of the chosen robots lose a share of speed in proportion to `where` (robots,)."""

    def apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
        amount = _amount(hardware, robots, values)
        _turned_by(
            hardware,
            lambda speeds, angles, poses, time: speeds * (1.0 - amount * where(poses)[:, None]),
        )

    return apply


def _on_carpet(poses: FloatArray) -> FloatArray:
    """1 on the half of the floor that has a carpet."""
    return np.asarray(poses[:, 1] > 0.0, dtype=np.float64)


def _crowded(poses: FloatArray) -> FloatArray:
    """1 for robots that touch, falling with the gap to the nearest."""
    apart = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    gap = np.maximum(apart.min(axis=1) - 2.0 * k.BODY_RADIUS, 0.0)
    return np.asarray(np.exp(-gap / REACH))


def _fast(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    amount = _amount(hardware, robots, values)
    _turned_by(
        hardware,
        lambda speeds, angles, poses, time: (
            speeds * (1.0 - amount * np.abs(speeds) / k.WHEEL_SPEED_MAX)
        ),
    )


def _lens(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    share = number(values, "share")

    def bend(poses: FloatArray) -> FloatArray:
        bent = poses.copy()
        squared = (poses[:, :2] ** 2).sum(axis=1, keepdims=True) / k.ARENA_RADIUS**2
        bent[:, :2] *= 1.0 - share * squared
        return bent

    hardware.laws.tracker = bend


def _sun(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    counts, direction = number(values, "counts"), number(values, "direction")
    hardware.laws.infrared = lambda directions, poses: (
        counts * np.maximum(np.cos(directions - direction), 0.0)
    )


def _flicker(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    share, period = number(values, "share"), number(values, "period")
    hardware.laws.lamp = lambda time: 1.0 + share * math.sin(2.0 * math.pi * time / period)


def _in_motion(name: str, physics: str, apply: Apply, *, per_robot: bool = True) -> Effect:
    """An effect on motion whose size is a share."""
    return Effect(
        name=name,
        kind="motion",
        physics=physics,
        parameters={"share": SHARE},
        apply=apply,
        per_robot=per_robot,
    )


UNLISTED: Mapping[str, Effect] = {
    effect.name: effect
    for effect in (
        Effect(
            name="eccentric_wheel",
            kind="motion",
            physics="the hub is off the wheel's middle: its speed changes as it turns",
            parameters={"share": SHARE, "wheel": WHEEL},
            apply=_eccentric,
        ),
        _in_motion(
            "carpet",
            "wheels turn slower on the left half of the floor",
            _slower_where(_on_carpet),
            per_robot=False,
        ),
        _in_motion("shy_robots", "wheels turn slower near another robot", _slower_where(_crowded)),
        _in_motion(
            "speed_loss", "the faster a wheel is told to turn, the larger the share it loses", _fast
        ),
        _in_motion(
            "lens",
            "the tracker's lens pulls what is far from the middle inwards",
            _lens,
            per_robot=False,
        ),
        Effect(
            name="low_sun",
            kind="infrared",
            physics="sensors that look one way read infrared from outside",
            parameters={
                "counts": Key(unit="counts", low=0.0, high=4095.0, null=0.0),
                "direction": Key(unit="rad", low=-math.pi, high=math.pi),
            },
            apply=_sun,
            per_robot=False,
        ),
        Effect(
            name="flicker",
            kind="light",
            physics="the lamp's power swings with time",
            parameters={
                "share": SHARE,
                "period": Key(unit="s", low=0.1, high=1000.0),
            },
            apply=_flicker,
            per_robot=False,
        ),
    )
}
"""By name."""

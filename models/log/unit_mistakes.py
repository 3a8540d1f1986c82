"""The usual mistakes of units and signs in a log, each with what to do about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from realitygap.embedded_sim import Drive

EPUCK_STEPS = 1000
"""Motor steps per revolution of an e-puck's wheel, whose speeds its firmware counts in steps/s."""


@dataclass(frozen=True)
class UnitReading:
    """One way to read a log's numbers; the defaults are the right one."""

    seen: str = ""
    """What the numbers look like."""
    fix: str = ""
    """What they should be."""
    time: float = 1.0
    """Multiplies, as the others that are no words."""
    length: float = 1.0
    angle: float = 1.0
    half_sine: bool = False
    """The yaw is the sine of half of it, as a quaternion's z is."""
    mirrored: bool = False
    command: float = 1.0


def mistakes(drive: Drive) -> list[UnitReading]:
    """The usual mistakes, each with what to do about it."""
    degree = np.pi / 180
    radius = sum(drive.wheel_radius) / 2
    lengths = [("millimetres", 1e-3), ("centimetres", 1e-2)]
    times = [("milliseconds", 1e-3), ("microseconds", 1e-6), ("nanoseconds", 1e-9)]
    angles = [
        ("yaw looks like degrees", "radians", degree, False),
        ("yaw looks clockwise", "radians counter-clockwise: change its sign", -1.0, False),
        ("yaw looks like clockwise degrees", "radians counter-clockwise", -degree, False),
        (
            "paths look mirrored",
            "y to the left of x, yaw counter-clockwise; or left and right commands swapped back",
            1.0,
            True,
        ),
    ]
    single = [
        UnitReading(f"x and y look like {name}", f"metres: multiply by {k:g}", length=k)
        for name, k in lengths
    ]
    single += [
        UnitReading(f"t looks like {name}", f"seconds: multiply by {k:g}", time=k)
        for name, k in times
    ]
    single += [
        UnitReading(seen, fix, angle=angle, mirrored=mirrored)
        for seen, fix, angle, mirrored in angles
    ]
    single.append(
        UnitReading(
            "yaw looks like the z of a quaternion",
            'radians: import it with yaw = { quaternion = ["qx", "qy", "qz", "qw"] }',
            half_sine=True,
        )
    )
    commands = [
        ("degrees per second", "rad/s", degree),
        ("metres per second of each wheel", "rad/s: divide by the wheel's radius", 1 / radius),
        ("millimetres per second", "rad/s or m/s", 1e-3),
        ("revolutions per minute", "rad/s", 2 * np.pi / 60),
        (
            "steps per second of an e-puck's motor",
            f"rad/s: multiply by 2 pi / {EPUCK_STEPS}",
            2 * np.pi / EPUCK_STEPS,
        ),
    ]
    single += [UnitReading(f"commands look like {n}", fix, command=k) for n, fix, k in commands]
    both = [
        UnitReading(
            f"x and y look like {name} and {seen}",
            f"metres (multiply by {k:g}) and {fix}",
            length=k,
            angle=angle,
            mirrored=mirrored,
        )
        for name, k in lengths
        for seen, fix, angle, mirrored in angles
    ]
    return single + both

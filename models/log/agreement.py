"""The usual mistakes of units and signs, and how well a log agrees with its commands under each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import Drive, replay
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Windows, motion, wrapped

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


WINDOW = 1.0
"""s; long against latencies of real robots (0.3 s), short against their drift."""
STEPS = (1e-3, 2.0)
"""s between rows that a log can have; beyond, time is in another unit."""
STILL = (2e-3, 2e-2)
"""m, rad: a motion below this says nothing."""


@dataclass(frozen=True, eq=False)
class Driven:
    """Rows of a log, one segment after another."""

    t: FloatArray
    """(rows,) s."""
    poses: FloatArray
    """(rows, 3) measured, NaN where lost."""
    commands: FloatArray
    """(rows, 2) rad/s."""
    start: npt.NDArray[np.int64]
    """(segments + 1,) first rows, and the row count."""
    drive: Drive
    """The nominal motion model."""

    def part(self, ranges: Sequence[tuple[int, int]]) -> Driven:
        """The rows from each first to before each last one, a segment each."""
        rows = np.concatenate([np.arange(first, last) for first, last in ranges])
        start = np.concatenate([[0], np.cumsum([last - first for first, last in ranges])])
        return Driven(self.t[rows], self.poses[rows], self.commands[rows], start, self.drive)

    def replayed(self, *, time: float = 1.0, command: float = 1.0) -> FloatArray:
        """(rows, 3) poses that the commands lead to from the origin, every number times its
        factor."""
        origin = np.zeros((len(self.start) - 1, 3))
        told = self.commands * command
        return replay(self.t * time, told, self.start, origin, drive=self.drive).poses


def usual_step(t: FloatArray) -> float | None:
    """Median s between rows in which time goes on; None: there are none."""
    steps = np.diff(t)
    return float(np.median(steps[steps > 0])) if (steps > 0).any() else None


def disagreement(rows: Driven, reading: UnitReading) -> float | None:
    """How little measured and replayed motion agree under a reading, 0 to 1; None: no telling.

    Per window |measured - replayed| / (|measured| + |replayed|), median over the windows that move;
    the worse of place and heading.
    """
    step = usual_step(rows.t * reading.time)
    if step is None or not STEPS[0] <= step <= STEPS[1]:
        return None
    ahead = max(1, round(WINDOW / step))
    if reading.half_sine and np.nanmax(np.abs(rows.poses[:, 2]), initial=0.0) > 1.0:
        return None
    driven = rows.replayed(time=reading.time, command=reading.command)
    seen = rows.poses * [reading.length, reading.length, reading.angle]
    if reading.half_sine:
        seen[:, 2] = 2.0 * np.arcsin(seen[:, 2])
    if reading.mirrored:
        seen = seen * [1.0, -1.0, -1.0]
    first = np.arange(len(rows.t) - ahead)
    segment = np.searchsorted(rows.start, np.arange(len(rows.t)), side="right")
    first = first[segment[first] == segment[first + ahead]]
    ok = np.isfinite(seen[first]).all(axis=1) & np.isfinite(seen[first + ahead]).all(axis=1)
    first = first[ok]
    if len(first) < 5:
        return None
    pairs = Windows(first, first + ahead)
    went, told = motion(seen, pairs), motion(driven, pairs)
    place = np.hypot(*(went - told)[:, :2].T)
    size = np.hypot(*went[:, :2].T) + np.hypot(*told[:, :2].T)
    turn = np.abs(wrapped(went[:, 2] - told[:, 2]))
    turned = np.abs(went[:, 2]) + np.abs(told[:, 2])
    parts = {
        name: float(np.median(np.minimum(off[moves] / total[moves], 1.0)))
        for name, off, total, least in (
            ("place", place, size, STILL[0]),
            ("heading", turn, turned, STILL[1]),
        )
        if (moves := total > max(least, float(np.median(total)))).sum() >= 5
    }
    # a unit is not right because in it there is next to nothing left to disagree about
    if reading.length != 1.0 and "place" not in parts:
        return None
    if (reading.half_sine or abs(reading.angle) != 1.0) and "heading" not in parts:
        return None
    return max(parts.values()) if parts else None


def contrast(rows: Driven) -> str:
    """What was commanded and what was measured, in words."""
    told, went = _rates(rows, rows.replayed()), _rates(rows, rows.poses)
    return f"commands of {told} and measured motion of {went}"


def _rates(rows: Driven, poses: FloatArray) -> str:
    """Median speed and turn rate of poses as the log counts them."""
    same = np.ones(len(rows.t) - 1, dtype=bool)
    same[rows.start[1:-1] - 1] = False
    change = np.abs(np.diff(poses, axis=0) / np.diff(rows.t)[:, None])[same]
    speed = float(np.nanmedian(np.hypot(change[:, 0], change[:, 1])))
    return f"{speed:.2g} m/s and {float(np.nanmedian(change[:, 2])):.2g} rad/s"

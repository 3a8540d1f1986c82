"""Are the units what they should be? Physics answers: what was commanded against what was measured.

A robot told to drive at 0.1 m/s does not move at 100 m/s, and one told to turn left does not turn
right. The log is replayed under each usual mistake (milliseconds, millimetres, degrees, clockwise
yaw, ...), over windows of about a second. If one mistake explains the measured motion and the log
as it stands does not, the log is refused and the mistake named. Names of columns play no part, and
a robot that simply drives badly agrees with no mistake better than with the truth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from embedded_sim import Drive, InputError, replay
from embedded_sim.model import FloatArray
from models.frames import Windows, motion, wrapped

WINDOW = 1.0
"""s; long against latencies of real robots (0.3 s), short against their drift."""
STEPS = (1e-3, 2.0)
"""s between rows that a log can have; beyond, time is in another unit."""
SAMPLE = 20_000
"""Rows looked at, from the start of every segment in turn: enough for any of these mistakes."""
ALONE = 500
"""Rows looked at, at least, of a robot that is judged alone."""
UNLIKE = 5.0
"""A robot's commands are in a unit of their own only if this many times those of the others, or
fewer: the smallest factor of `mistakes` is twice that. A motor that does not obey is a fault."""
GOOD = 0.35
"""Disagreement (0: none, 1: unrelated) below which motion agrees. A motor at half speed: 0.33."""
BETTER = 0.5
"""A mistake must halve the disagreement to be believed."""
TOO_FAST = 10.0
"""Times the fastest a wheel turns: beyond any other robot's motor, within any mistake of units."""
STILL = (2e-3, 2e-2)
"""m, rad: a motion below this says nothing."""
EPUCK_STEPS = 1000
"""Motor steps per revolution of an e-puck's wheel, whose speeds its firmware counts in steps/s."""


@dataclass(frozen=True)
class Reading:
    """One way to read a log's numbers; the defaults are the right one."""

    seen: str = ""
    fix: str = ""
    time: float = 1.0
    length: float = 1.0
    angle: float = 1.0
    mirrored: bool = False
    command: float = 1.0


def mistakes(drive: Drive) -> list[Reading]:
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
        Reading(f"x and y look like {name}", f"metres: multiply by {k:g}", length=k)
        for name, k in lengths
    ]
    single += [
        Reading(f"t looks like {name}", f"seconds: multiply by {k:g}", time=k) for name, k in times
    ]
    single += [
        Reading(seen, fix, angle=angle, mirrored=mirrored) for seen, fix, angle, mirrored in angles
    ]
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
    single += [Reading(f"commands look like {n}", fix, command=k) for n, fix, k in commands]
    both = [
        Reading(
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


def check_units(
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    start: npt.NDArray[np.int64],
    *,
    drive: Drive,
    names: Sequence[str],
    fastest: float | None = None,
) -> None:
    """Refuse a log whose measured motion is explained by a mistake of units or signs.

    Args:
        t: (rows,) s.
        poses: (rows, 3) measured, NaN where lost.
        commands: (rows, 2) rad/s.
        start: (segments + 1,) first rows, and the row count.
        drive: The nominal motion model.
        names: (segments,) what to call each in a refusal.
        fastest: rad/s, most a wheel of this robot turns, if known.

    Raises:
        InputError: says what the numbers look like and what was expected.
    """
    _check_moving(poses, commands, start)
    _check_alone(t, poses, commands, start, drive, names)
    rows = _sample(start)
    cut = np.concatenate([[0], np.cumsum([b - a for a, b in rows])])
    taken = np.concatenate([np.arange(a, b) for a, b in rows])
    t, poses, commands = t[taken], poses[taken], commands[taken]
    step = float(np.median(np.diff(t)[np.diff(t) > 0])) if (np.diff(t) > 0).any() else 1.0
    _check_step(step)
    _check_mistakes(t, poses, commands, cut, drive)
    _check_speed(commands, drive, fastest)


def _check_mistakes(
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    cut: npt.NDArray[np.int64],
    drive: Drive,
) -> None:
    """Refuse a log that a usual mistake explains and that does not agree as it stands."""
    asis = _disagreement(t, poses, commands, cut, drive, Reading())
    mistake = _mistaken(asis, t, poses, commands, cut, drive, mistakes(drive))
    if mistake is not None:
        seen = f"{_contrast(t, poses, commands, cut, drive)} ({mistake.seen})"
        raise InputError("log", seen, mistake.fix)


def _check_alone(
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    start: npt.NDArray[np.int64],
    drive: Drive,
    names: Sequence[str],
) -> None:
    """Refuse a log in which some robots are logged in a unit of their own, and name them.

    Signs are not judged: a robot whose motors are swapped drives a mirrored path.
    """
    found: dict[int, Reading | None] = {}
    rows = _sample(start, ALONE)
    if len(rows) < 2:
        return
    level = np.array([float(np.quantile(np.abs(commands[a:b]), 0.9)) for a, b in rows])
    for k, (a, b) in enumerate(rows):
        part = (t[a:b], poses[a:b], commands[a:b], np.array([0, b - a]), drive)
        asis = _disagreement(*part, Reading())
        if asis is None:
            continue
        usual = float(np.median(np.delete(level, k)))
        unlike = not usual / UNLIKE <= level[k] <= usual * UNLIKE
        units = [
            m
            for m in mistakes(drive)
            if m.length != 1.0 or abs(m.angle) != 1.0 or (unlike and m.command != 1.0)
        ]
        found[k] = _mistaken(asis, *part, units)
    odd = [k for k, mistake in found.items() if mistake is not None]
    seen = {mistake.seen for mistake in found.values() if mistake is not None}
    if not odd or (len(odd) == len(found) and len(seen) == 1):
        return  # what all robots have in common is the log's own unit
    a, b = rows[odd[0]]
    mistake = found[odd[0]]
    assert mistake is not None
    more = f" and {len(odd) - 1} more" if len(odd) > 1 else ""
    contrast = _contrast(t[a:b], poses[a:b], commands[a:b], np.array([0, b - a]), drive)
    raise InputError(
        f"{names[odd[0]]}{more}", f"{contrast} ({mistake.seen}, not as others)", mistake.fix
    )


def _mistaken(
    asis: float | None,
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    cut: npt.NDArray[np.int64],
    drive: Drive,
    readings: Sequence[Reading],
) -> Reading | None:
    """The reading that explains rows which disagree as they stand, if one does."""
    if asis is None or asis <= GOOD:
        return None
    tried = [
        (d, m)
        for m in readings
        if (d := _disagreement(t, poses, commands, cut, drive, m)) is not None
    ]
    best, mistake = min(tried, key=lambda pair: pair[0], default=(1.0, Reading()))
    return mistake if best <= GOOD and best <= BETTER * asis else None


def _contrast(
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    cut: npt.NDArray[np.int64],
    drive: Drive,
) -> str:
    """What was commanded and what was measured."""
    replayed = replay(t, commands, cut, np.zeros((len(cut) - 1, 3)), drive=drive).poses
    told, went = _rates(t, replayed, cut), _rates(t, poses, cut)
    return f"commands of {told} and measured motion of {went}"


def _check_speed(commands: FloatArray, drive: Drive, fastest: float | None) -> None:
    """Refuse commands no wheel could follow: measured and commanded in one wrong unit agree."""
    told = float(np.quantile(np.abs(commands), 0.9))
    if fastest is not None and told > TOO_FAST * fastest:
        ground = told * sum(drive.wheel_radius) / 2
        raise InputError(
            "commands",
            f"wheel speeds of {told:.3g} rad/s ({ground:.3g} m/s)",
            f"at most {fastest:g} rad/s on this robot: are lengths in millimetres throughout?",
        )


def _check_step(step: float) -> None:
    """Refuse time in another unit by the time between rows."""
    if STEPS[0] <= step <= STEPS[1]:
        return
    for name, k in (("milliseconds", 1e-3), ("microseconds", 1e-6), ("nanoseconds", 1e-9)):
        if STEPS[0] <= step * k <= STEPS[1]:
            raise InputError(
                "t", f"a row each {step:g} s ({name}?)", f"seconds: multiply t by {k:g}"
            )
    raise InputError("t", f"a row each {step:g} s", f"rows {STEPS[0]:g} to {STEPS[1]:g} s apart")


def _check_moving(poses: FloatArray, commands: FloatArray, start: npt.NDArray[np.int64]) -> None:
    """Refuse a log whose robots move though never commanded, or are commanded and never move.

    Each robot is compared with itself alone: robots stand at different places.
    """
    moves = [_moves(poses[a:b], commands[a:b]) for a, b in pairwise(start)]
    known = [one for one in moves if one is not None]
    furthest = max((max(one.span[:2]) for one in known), default=0.0)
    if not commands.any() and furthest > 0.05:
        raise InputError(
            "commands",
            f"zero in every row while x or y moves {furthest:.3g} m",
            "the commanded speeds",
        )
    driven = [one for one in known if one.ahead or one.turning]
    if not driven:
        return
    still = [
        name
        for k, name in enumerate(("x", "y", "yaw"))
        if all(one.span[k] == 0.0 for one in driven)
    ]
    ahead, turning = any(one.ahead for one in driven), any(one.turning for one in driven)
    if (
        ({"x", "y"} <= set(still) and (ahead or "yaw" in still))
        or (still == ["yaw"] and turning)
        or (len(still) == 1 and max(one.span[2] for one in driven) > 1.0)
    ):
        raise InputError(
            " and ".join(still),
            "one value in every row of robots that are driven",
            "measured poses",
        )


class _Moves(NamedTuple):
    """How one robot moves in one run, and how it is told to."""

    span: tuple[float, ...]
    """m, m, rad: largest less smallest x, y and yaw."""
    ahead: bool
    turning: bool


def _moves(poses: FloatArray, commands: FloatArray) -> _Moves | None:
    """The moves of one robot in one run; None: it was seen less than twice."""
    known = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if len(known) < 2:
        return None
    left, right = commands[known[0] : known[-1]].T  # what was told before it was last seen
    return _Moves(
        span=tuple(float(width) for width in np.ptp(poses[known], axis=0)),
        ahead=not np.allclose(left, -right),
        turning=bool((left != right).any()),
    )


def _sample(start: npt.NDArray[np.int64], least: int = 50) -> list[tuple[int, int]]:
    """Row ranges from the start of every segment, about `SAMPLE` rows in all."""
    each = max(int(SAMPLE / (len(start) - 1)), least)
    ranges = [(int(a), int(min(b, a + each))) for a, b in pairwise(start)]
    return ranges[: max(1, SAMPLE // 50)]


def _disagreement(
    t: FloatArray,
    poses: FloatArray,
    commands: FloatArray,
    cut: npt.NDArray[np.int64],
    drive: Drive,
    reading: Reading,
) -> float | None:
    """How little measured and replayed motion agree under a reading, 0 to 1; None: no telling.

    Per window |measured - replayed| / (|measured| + |replayed|), median over the windows that move;
    the worse of place and heading.
    """
    time = t * reading.time
    step = float(np.median(np.diff(time)[np.diff(t) > 0])) if (np.diff(t) > 0).any() else 0.0
    if not STEPS[0] <= step <= STEPS[1]:
        return None
    ahead = max(1, round(WINDOW / step))
    driven = replay(
        time, commands * reading.command, cut, np.zeros((len(cut) - 1, 3)), drive=drive
    ).poses
    seen = poses * [reading.length, reading.length, reading.angle]
    if reading.mirrored:
        seen = seen * [1.0, -1.0, -1.0]
    first = np.arange(len(time) - ahead)
    segment = np.searchsorted(cut, np.arange(len(time)), side="right")
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
    if abs(reading.angle) != 1.0 and "heading" not in parts:
        return None
    return max(parts.values()) if parts else None


def _rates(t: FloatArray, poses: FloatArray, cut: npt.NDArray[np.int64]) -> str:
    """Median speed and turn rate of poses as the log counts them."""
    same = np.ones(len(t) - 1, dtype=bool)
    same[cut[1:-1] - 1] = False
    change = np.abs(np.diff(poses, axis=0) / np.diff(t)[:, None])[same]
    speed = float(np.nanmedian(np.hypot(change[:, 0], change[:, 1])))
    return f"{speed:.2g} m/s and {float(np.nanmedian(change[:, 2])):.2g} rad/s"

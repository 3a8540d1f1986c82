"""Are the units what they should be? Physics answers: what was commanded against what was measured.

A robot told to drive at 0.1 m/s does not move at 100 m/s, and one told to turn left does not turn
right. The log is replayed under each usual mistake (milliseconds, millimetres, degrees, clockwise
yaw, ...), over windows of about a second. If one mistake explains the measured motion and the log
as it stands does not, the log is refused and the mistake named. Names of columns play no part, and
a robot that simply drives badly agrees with no mistake better than with the truth.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import Drive, InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.agreement import (
    STEPS,
    Driven,
    UnitReading,
    contrast,
    disagreement,
    mistakes,
    usual_step,
)
from realitygap.models.log.schema import ENCODERS

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
MOVED = 0.05
"""m: a robot surely moved. Our choice."""
TOO_FAST = 10.0
"""Times the fastest a wheel turns: beyond any other robot's motor, within any mistake of units."""


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
    log = Driven(t, poses, commands, start, drive)
    _check_alone(log, names)
    rows = log.part(_sample(start))
    step = usual_step(rows.t)
    _check_step(1.0 if step is None else step)
    _check_mistakes(rows)
    _check_speed(rows.commands, drive, fastest)


def _check_mistakes(rows: Driven) -> None:
    """Refuse a log that a usual mistake explains and that does not agree as it stands."""
    mistake = _mistaken(rows, disagreement(rows, UnitReading()), mistakes(rows.drive))
    if mistake is not None:
        raise InputError("log", f"{contrast(rows)} ({mistake.seen})", mistake.fix)


def _check_alone(log: Driven, names: Sequence[str]) -> None:
    """Refuse a log in which some robots are logged in a unit of their own, and name them.

    Signs are not judged: a robot whose motors are swapped drives a mirrored path.
    """
    found: dict[int, UnitReading | None] = {}
    parts = [log.part([one]) for one in _sample(log.start, ALONE)]
    if len(parts) < 2:
        return
    level = np.array([float(np.quantile(np.abs(rows.commands), 0.9)) for rows in parts])
    for k, rows in enumerate(parts):
        asis = disagreement(rows, UnitReading())
        if asis is None:
            continue
        usual = float(np.median(np.delete(level, k)))
        unlike = not usual / UNLIKE <= level[k] <= usual * UNLIKE
        units = [
            m
            for m in mistakes(log.drive)
            if m.length != 1.0 or abs(m.angle) != 1.0 or (unlike and m.command != 1.0)
        ]
        found[k] = _mistaken(rows, asis, units)
    odd = [(k, mistake) for k, mistake in found.items() if mistake is not None]
    seen = {mistake.seen for _, mistake in odd}
    if not odd or (len(odd) == len(found) and len(seen) == 1):
        return  # what all robots have in common is the log's own unit
    first, mistake = odd[0]
    more = f" and {len(odd) - 1} more" if len(odd) > 1 else ""
    said = f"{contrast(parts[first])} ({mistake.seen}, not as others)"
    raise InputError(f"{names[first]}{more}", said, mistake.fix)


def _mistaken(
    rows: Driven, asis: float | None, readings: Sequence[UnitReading]
) -> UnitReading | None:
    """The reading that explains rows which disagree as they stand, if one does."""
    if asis is None or asis <= GOOD:
        return None
    tried = [(d, m) for m in readings if (d := disagreement(rows, m)) is not None]
    best, mistake = min(tried, key=lambda pair: pair[0], default=(1.0, UnitReading()))
    return mistake if best <= GOOD and best <= BETTER * asis else None


def _check_speed(commands: FloatArray, drive: Drive, fastest: float | None) -> None:
    """Refuse commands no wheel could follow: measured and commanded in one wrong unit agree."""
    told = float(np.quantile(np.abs(commands), 0.9))
    if fastest is not None and told > TOO_FAST * fastest:
        ground = told * sum(drive.wheel_radius) / 2
        raise InputError(
            "commands",
            f"wheel speeds of {told:.3g} rad/s ({ground:.3g} m/s)",
            f"at most {fastest:g} rad/s on this robot: are lengths in millimetres throughout, or "
            "is it another --model?",
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
    if not commands.any() and furthest > MOVED:
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


def check_counting(wheels: FloatArray, poses: FloatArray, start: npt.NDArray[np.int64]) -> None:
    """Refuse encoders that never count though a robot moves.

    Args:
        wheels: (rows, 2) rad/s by the encoders, NaN where not.
        poses: (rows, 3) measured, NaN where lost.
        start: (segments + 1,) first rows, and the row count.

    Raises:
        InputError: they are zero in every row.
    """
    known = np.isfinite(wheels)
    if not known.any() or wheels[known].any():
        return
    moves = [_moves(poses[a:b], wheels[a:b]) for a, b in pairwise(start)]
    far = max((max(one.span[:2]) for one in moves if one is not None), default=0.0)
    if far > MOVED:
        seen = f"zero in every row while x or y moves {far:.3g} m"
        raise InputError(" and ".join(ENCODERS), seen, "what the encoders counted, or no columns")


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

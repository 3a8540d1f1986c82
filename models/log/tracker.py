"""The tracker's failures: single wild poses are set aside and counted, a broken track is refused.

Real trackers lose a robot for a moment, take a reflection for a marker, or swap two robots: one to
four per cent of samples are gross failures. A pose far from the median of its neighbours is such a
failure; a track that jumps and stays away begins a new stretch; a track that jumps all the time is
no track.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows, wrapped

REACH = 3
"""Rows on each side whose median a pose is compared with: failures of up to three rows are seen."""
WILD = 10.0
"""Robust standard deviations from that median. Our choice: never reached by normal noise."""
LEAST = (2e-3, 2e-2)
"""m, rad: nearer to the median than this a pose is never wild, however quiet the tracker."""
MOST_WILD = 0.1
"""Share of wild poses or jumps beyond which a track is refused (real trackers: up to 0.04)."""
MOST_LOST = 0.5
"""Share of a robot's poses that may be missing before it is refused."""
OFTEN = 0.2
"""Share of rows of motion that repeat a pose from which on poses are held. Our choice: a tracker a
fifth slower than the log; noise of any size repeats none, a millimetre's rounding a few."""
FROZEN = 0.98
"""The same beyond which a robot stands still or its track does. Our choice: a tracker fifty times
slower than the log tells nothing of motion."""
FASTER = 4.0
"""A jump is a step this many times what the fastest command allows."""

NORMAL = 1.4826
"""Standard deviation of a normal variable per median absolute deviation."""

Flags = npt.NDArray[np.bool_]
NO_COURSE = (
    "without a heading: it stands, turns on the spot, has just reversed, or is slow beside the "
    "tracker's noise",
    "a column yaw, or a robot that mostly drives on",
)
"""What is said of robots whose positions mostly do not tell where they face."""


class Repair(NamedTuple):
    """What became of a track."""

    tracked: Flags
    """(rows,) the pose can be used."""
    jumps: Flags
    """(rows,) the track continues elsewhere from this row on."""
    notes: list[str]


def repair(
    poses: FloatArray,
    t: FloatArray,
    stretch: Rows,
    segment: Rows,
    names: list[str],
    fastest: float,
    *,
    headed: bool = True,
) -> Repair:
    """Set aside wild poses and cut tracks where they jump.

    Args:
        poses: (rows, 3) measured, NaN where lost.
        t: (rows,) s.
        stretch: (rows,) uninterrupted stretch of each row; nothing is compared across two.
        segment: (rows,) which robot in which run.
        names: (segments,) what to call each in a refusal.
        fastest: m/s, the highest commanded speed.
        headed: Whether the tracker told headings; else they are courses.

    Raises:
        InputError: a robot's poses are mostly missing, or jump so often that it is no track.
    """
    notes = []
    lost: Flags = np.asarray(np.isnan(poses).any(axis=1))
    measured = ~lost
    seen, expected = ("without a pose", "poses in most rows: leave it out") if headed else NO_COURSE
    _refuse(_missing(lost, segment), segment, names, MOST_LOST, seen, expected)
    if lost.any():
        longest = _longest(lost, stretch)
        notes.append(f"{lost.sum()} rows without a pose set aside (at most {longest} in a row)")
    wild = measured & _wild(poses, stretch, fastest, t)
    if wild.any():
        notes.append(f"{wild.sum()} poses far from their neighbours set aside as tracker failures")
    tracked = measured & ~wild
    jumps = _jumps(poses, t, stretch, tracked, fastest)
    _refuse(
        wild | jumps,
        segment,
        names,
        MOST_WILD,
        "where the pose jumps",
        "one continuous track: are two robots logged under one id, or rows out of order?",
    )
    if jumps.any():
        notes.append(f"{jumps.sum()} jumps of the tracker: nothing is replayed across them")
    return Repair(tracked, jumps, notes)


def _missing(lost: Flags, segment: Rows) -> Flags:
    """(rows,) lost where a tracker that is slower than the log should have had a pose.

    Of rows that come so many to a pose, one is expected to have it.
    """
    known = np.flatnonzero(~lost)
    same = np.diff(segment[known]) == 0
    each = int(np.median(np.diff(known)[same])) if same.any() else 1
    if each == 1:
        return lost
    since = np.arange(len(lost)) - np.concatenate([[0], known])[np.cumsum(~lost)]
    return np.asarray(lost & (since % each == 0))


def held(poses: FloatArray, moving: Flags, segment: Rows) -> Flags:
    """(rows,) the pose repeats the row before: a tracker slower than the log, whose poses are held.

    None where robots that are told to move hardly ever repeat one: noise does not.

    Args:
        poses: (rows, 3) measured.
        moving: (rows,) told to move.
        segment: (rows,) which robot in which run.
    """
    again = np.zeros(len(poses), dtype=bool)
    again[1:] = (poses[1:] == poses[:-1]).all(axis=1) & (segment[1:] == segment[:-1])
    told = np.maximum(np.bincount(segment, moving), 1)
    share = np.bincount(segment, again & moving, len(told)) / told
    slow = (share > OFTEN) & (share < FROZEN)
    return np.asarray(again & slow[segment])


def _wild(poses: FloatArray, stretch: Rows, fastest: float, t: FloatArray) -> Flags:
    """(rows,) far from the median of the rows around, in place or heading."""
    rows = len(poses)
    if rows < 2 * REACH + 1:
        return np.zeros(rows, dtype=bool)
    around = np.clip(np.arange(rows)[:, None] + np.arange(-REACH, REACH + 1), 0, rows - 1)
    inside = stretch[around] == stretch[:, None]
    facing = np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
    signals = np.column_stack([poses[:, :2], facing])
    centre = np.empty_like(signals)
    for k in range(4):
        near = np.where(inside, signals[around, k], np.nan)
        lost = np.isnan(near).all(axis=1)
        near[lost] = 0.0
        centre[:, k] = np.nanmedian(near, axis=1)
    away = np.hypot(*(signals[:, :2] - centre[:, :2]).T)
    turned = np.abs(wrapped(poses[:, 2] - np.arctan2(centre[:, 3], centre[:, 2])))
    # a robot that turns or reverses within the window leaves its own median a little
    slack = fastest * float(np.median(np.abs(np.diff(t)))) * REACH
    return _beyond(away, LEAST[0] + slack) | _beyond(turned, LEAST[1] + 20.0 * slack)


def _beyond(distance: FloatArray, least: float) -> Flags:
    """Further out than noise ever is."""
    spread = NORMAL * float(np.nanmedian(distance)) if np.isfinite(distance).any() else 0.0
    return np.asarray(distance > max(WILD * spread, least))


def _jumps(
    poses: FloatArray,
    t: FloatArray,
    stretch: Rows,
    tracked: Flags,
    fastest: float,
) -> Flags:
    """(rows,) tracked rows whose pose no robot could have reached from the last tracked one."""
    rows = np.flatnonzero(tracked)
    jumps = np.zeros(len(poses), dtype=bool)
    if len(rows) < 2:
        return jumps
    same = stretch[rows[1:]] == stretch[rows[:-1]]
    far = np.hypot(*(poses[rows[1:], :2] - poses[rows[:-1], :2]).T)
    # two tracks in one alternate: every other row is near, and that is what noise looks like
    nearer = np.append(np.hypot(*(poses[rows[2:], :2] - poses[rows[:-2], :2]).T), np.inf)
    noise = NORMAL * float(np.median(np.minimum(far, nearer)[same])) if same.any() else 0.0
    most = FASTER * fastest * (t[rows[1:]] - t[rows[:-1]]) + WILD * noise + LEAST[0]
    jumps[rows[1:]] = same & (far > most)
    return jumps


def _refuse(
    flags: Flags, segment: Rows, names: list[str], most: float, seen: str, expected: str
) -> None:
    """Refuse the robot with the largest share of flagged rows if it has too many."""
    count, rows = np.bincount(segment, flags), np.bincount(segment)
    worst = int(np.argmax(count / rows))
    if count[worst] > max(most * rows[worst], 2):
        raise InputError(
            names[worst], f"{int(count[worst])} of {rows[worst]} rows {seen}", expected
        )


def _longest(flags: Flags, stretch: Rows) -> int:
    """Longest run of flagged rows."""
    start = flags & ~np.concatenate([[False], flags[:-1] & (stretch[1:] == stretch[:-1])])
    return int(np.bincount(np.cumsum(start)[flags]).max()) if flags.any() else 0

"""What the tracker and the encoders should have seen if robots moved as believed."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from realitygap.embedded_sim import Drive, replay
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.identify.tracks import AROUND, Rows, Tracks

WIDEST = 0.25
"""Of its neighbours that one pass of an average may take: more would swing. No rule: of
numerics."""
REGULAR = 1e-6
"""Relative deviation from an even rate that written times may have. No rule: rounding."""


def poses(tracks: Tracks, motions: Sequence[Motion]) -> FloatArray:
    """(n, 3) predicted measured poses at the tracks' `rows`, each segment from the origin.

    Args:
        tracks: Whose commands.
        motions: One per robot of `tracks.robots`.
    """
    path = np.empty((len(tracks.t), 3))
    for robot, (begin, end, cut) in enumerate(_pieces(tracks)):
        motion = motions[robot]
        path[begin:end] = driven(
            tracks.t[begin:end],
            tracks.commands[begin:end],
            cut,
            motion.drive,
            motion.motor_delay + motion.pose_delay,
        )
        path[begin:end] = recorded(tracks.t[begin:end], path[begin:end], cut, motion)
    seen = path[tracks.rows]
    lever = np.array([m.lever for m in motions])
    if lever.any():
        arm = lever[tracks.row_robot[tracks.rows]]
        c, s = np.cos(seen[:, 2]), np.sin(seen[:, 2])
        seen[:, 0] += c * arm[:, 0] - s * arm[:, 1]
        seen[:, 1] += s * arm[:, 0] + c * arm[:, 1]
    scale = np.array([m.pose_scale for m in motions])
    if (scale != 1.0).any():
        seen[:, :2] *= scale[tracks.row_robot[tracks.rows], None]
    turned = np.array([m.yaw_offset for m in motions])
    if turned.any():
        seen[:, 2] += turned[tracks.row_robot[tracks.rows]]
    return seen


def wheel_angles(tracks: Tracks, motions: Sequence[Motion]) -> FloatArray:
    """(rows, 2) rad each wheel has turned by each row, from 0 at its segment's first row."""
    angles = np.empty((len(tracks.t), 2))
    for robot, (begin, end, cut) in enumerate(_pieces(tracks)):
        drive = motions[robot].wheels
        for side in (0, 1):
            # a body with one wheel of 1 m and an axle of 1 m turns as that wheel does
            radius = (0.0, 1.0) if side else (-1.0, 0.0)
            alone = _with(drive, wheel_radius=radius, axle=1.0)
            turned = driven(
                tracks.t[begin:end],
                tracks.commands[begin:end],
                cut,
                alone,
                motions[robot].motor_delay,
            )
            angles[begin:end, side] = turned[:, 2]
    return angles


def _pieces(tracks: Tracks) -> list[tuple[int, int, Rows]]:
    """Per robot: its first row, the row after its last, and its segments' first rows from there."""
    edge = np.searchsorted(tracks.segment_robot, np.arange(len(tracks.robots) + 1))
    found = []
    for a, b in pairwise(edge):
        cut = tracks.start[a : b + 1]
        found.append((int(cut[0]), int(cut[-1]), cut - cut[0]))
    return found


def driven(
    t: FloatArray, commands: FloatArray, cut: Rows, drive: Drive, delay: float
) -> FloatArray:
    """(rows, 3) poses at the times when the rows' poses were really taken.

    Args:
        t: (rows,) s.
        commands: (rows, 2) rad/s.
        cut: (segments + 1,) first row of each segment, and the row count; each from the origin.
        drive: What moves the robot.
        delay: s by which its answer shows late, beyond the drive's latency; negative: early.
    """
    total = drive.latency + delay
    origin = np.zeros((len(cut) - 1, 3))
    if (
        total >= 0.0 or len(t) < 2
    ):  # one row goes nowhere; late poses and late commands are the same in motion
        return replay(t, commands, cut, origin, drive=_with(drive, latency=max(total, 0.0))).poses
    took = np.diff(t)
    left_out = took > AROUND  # rows between windows: none of these looks so far
    whole = len(cut) == 2 and not left_out.any()
    step = (t[-1] - t[0]) / (len(t) - 1) if whole else float(np.median(took))
    regular = np.abs(took - step) < REGULAR * step
    regular[cut[1:-1] - 1] = True
    regular |= left_out
    if not regular.all():
        return _ahead(t, commands, cut, _with(drive, latency=0.0), -total)
    rows = int(np.ceil(-total / step))
    earlier = np.minimum(np.arange(len(t)) + rows, np.repeat(cut[1:], np.diff(cut)) - 1)
    given = np.ascontiguousarray(commands[earlier])
    shifted = _with(drive, latency=rows * step + total)
    return replay(t, given, cut, origin, drive=shifted).poses


def recorded(t: FloatArray, path: FloatArray, cut: Rows, motion: Motion) -> FloatArray:
    """(rows, 3) poses of one robot as a tracker with another clock that averages has them.

    Args:
        t: (rows,) s.
        path: (rows, 3), each segment by itself.
        cut: (segments + 1,) first row of each segment, and the row count.
        motion: Whose `clock_rate` and `smear`.
    """
    if not motion.clock_rate and not motion.smear:
        return path
    found = path.copy()
    for begin, end in pairwise(cut.tolist()):
        own, at = found[begin:end], t[begin:end]
        if end - begin < 3:
            continue
        if motion.clock_rate:
            taken = at - motion.clock_rate * (at - t[0])
            own[:] = np.column_stack([np.interp(taken, at, own[:, k]) for k in range(3)])
        if motion.smear:
            step = (at[-1] - at[0]) / (len(at) - 1)
            share = 0.5 * motion.smear / step**2  # of each neighbour: variance of three rows
            rounds = max(1, int(np.ceil(share / WIDEST)))
            for _ in range(rounds):
                own[1:-1] += share / rounds * (own[2:] - 2.0 * own[1:-1] + own[:-2])
    return found


def _ahead(
    t: FloatArray, commands: FloatArray, cut: Rows, drive: Drive, seconds: float
) -> FloatArray:
    """(rows, 3) poses that a robot will have some seconds after each row's time."""
    segment = np.repeat(np.arange(len(cut) - 1), np.diff(cut))
    far = 2.0 * (float(np.ptp(t)) + seconds + 1.0)  # keeps segments apart on one axis of time
    axis = t + far * segment
    both = np.concatenate([axis, axis + seconds])
    order = np.argsort(both, kind="stable")
    later = np.empty(len(both), dtype=np.int64)
    later[order] = np.arange(len(both))
    given = np.searchsorted(axis, both[order], side="right") - 1
    new = np.searchsorted(both[order], axis[cut[:-1]])
    times = both[order] - far * segment[given]
    times, kept = _increasing(times, np.append(new, len(times)))
    starts = np.append(kept[new], len(times))
    taken = np.flatnonzero(np.concatenate([[True], np.diff(kept) > 0]))
    origin = np.zeros((len(cut) - 1, 3))
    driven = replay(times, commands[given[taken]], starts, origin, drive=drive).poses
    return np.asarray(driven[kept[later[len(t) :]]])


def _increasing(times: FloatArray, starts: Rows) -> tuple[FloatArray, Rows]:
    """Times without repetitions within a segment, and where each of the old ones is among them."""
    new = np.ones(len(times), dtype=bool)
    new[1:] = np.diff(times) > 1e-9
    new[starts[:-1]] = True
    return times[new], np.cumsum(new) - 1


def _with(drive: Drive, **changes: object) -> Drive:
    """The drive with some fields replaced; faster than `dataclasses.replace` in the fit's loop."""
    values = {name: getattr(drive, name) for name in Drive.__dataclass_fields__}
    return Drive(**{**values, **changes})

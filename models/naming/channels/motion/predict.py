"""What the tracker and the encoders should have seen if robots moved as believed."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.conditions import asked
from realitygap.models.gap.driven import AROUND, driven, recorded, wheel_turns
from realitygap.models.naming.channels.motion.tracks import Rows, Tracks

TICK = 2.0 * np.pi / 1000.0
"""rad; encoders are never taken to be finer than an e-puck's 1000 steps a turn.
No rule: of its data sheet."""


def poses(tracks: Tracks, motions: Sequence[Motion]) -> FloatArray:
    """(n, 3) predicted measured poses at the tracks' `rows`, each segment from the origin.

    Args:
        tracks: Whose commands.
        motions: One per robot of `tracks.robots`.
    """
    path = np.empty((len(tracks.t), 3))
    pieces = _pieces(tracks)
    if all(one == motions[0] and _plain(one) for one in motions):  # all at once
        pieces = [(0, len(tracks.t), tracks.start, tracks.rolling)]
    for motion, (begin, end, cut, rolling) in zip(motions, pieces, strict=False):
        path[begin:end] = driven(
            tracks.t[begin:end],
            tracks.commands[begin:end],
            cut,
            motion.drive,
            motion.motor_delay + motion.pose_delay,
            tracks.seen[begin:end] if asked(motion.drive) else None,
            rolling,
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


def _plain(motion: Motion) -> bool:
    """Whether a segment's path does not depend on how the rows of others lie in time."""
    late = motion.drive.latency + motion.motor_delay + motion.pose_delay >= 0.0
    return late and not (motion.clock_rate or motion.smear or motion.pose_lag)


def wheel_angles(tracks: Tracks, motions: Sequence[Motion]) -> FloatArray:
    """(rows, 2) rad each wheel has turned by each row, from 0 at its segment's first row."""
    angles = np.empty((len(tracks.t), 2))
    for robot, (begin, end, cut, rolling) in enumerate(_pieces(tracks)):
        angles[begin:end] = wheel_turns(
            tracks.t[begin:end],
            tracks.commands[begin:end],
            cut,
            motions[robot].wheels,
            motions[robot].motor_delay,
            rolling,
        )
        angles[begin:end] *= motions[robot].wheel_gain
    return angles


def wheel_errors(tracks: Tracks, motions: Sequence[Motion]) -> tuple[FloatArray, Rows]:
    """Encoders less what they should read (rad/s), and which rows these are.

    Returns:
        (n, 2) errors of the mean speed since the row before, and (n,) rows.
    """
    assert tracks.encoders is not None
    angle = wheel_angles(tracks, motions)
    took = np.diff(tracks.t, prepend=tracks.t[0] - 1.0)
    inside = took < AROUND  # rows were left out where more time has passed
    inside[tracks.start[:-1]] = False
    speed = np.diff(angle, axis=0, prepend=angle[:1]) / np.where(inside, took, 1.0)[:, None]
    off = tracks.encoders - speed
    rows = np.flatnonzero(inside & np.isfinite(off).all(axis=1))
    return off[rows], rows


def coarse(step: float) -> float:
    """rad/s: what a tick leaves of a speed over a step (s)."""
    return float(TICK / step / np.sqrt(6.0))


def _pieces(tracks: Tracks) -> list[tuple[int, int, Rows, FloatArray | None]]:
    """Per robot: its first row, the row after its last, its segments' first rows from there, and
    how fast its wheels turn in these."""
    edge = np.searchsorted(tracks.segment_robot, np.arange(len(tracks.robots) + 1))
    found = []
    for a, b in pairwise(edge):
        cut = tracks.start[a : b + 1]
        rolling = None if tracks.rolling is None else tracks.rolling[a:b]
        found.append((int(cut[0]), int(cut[-1]), cut - cut[0], rolling))
    return found

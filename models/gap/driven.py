"""Where commands take a robot, and where a tracker with a clock of its own shows it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from realitygap.embedded_sim import Drive, replay
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.log.frames import Rows

AROUND = 2.0
"""s before and after the windows used of a long log whose rows are kept: what a robot was told then
may still show in its windows, for it may be late, or its clock early.
No rule: the catalogue bounds both."""
WIDEST = 0.25
"""Of its neighbours that one pass of an average may take: more would swing. No rule: of
numerics."""
REGULAR = 1e-6
"""Relative deviation from an even rate that written times may have. No rule: rounding."""


def driven(
    t: FloatArray,
    commands: FloatArray,
    cut: Rows,
    drive: Drive,
    delay: float,
    seen: FloatArray | None = None,
    rolling: FloatArray | None = None,
) -> FloatArray:
    """(rows, 3) poses at the times when the rows' poses were really taken.

    Args:
        t: (rows,) s.
        commands: (rows, 2) rad/s.
        cut: (segments + 1,) first row of each segment, and the row count; each from the origin.
        drive: What moves the robot.
        delay: s by which its answer shows late, beyond the drive's latency; negative: early.
        seen: (rows, 4) where laws find the robot (`gap.around`); None: where the replay has it.
        rolling: (segments, 2) rad/s of the wheels at first (`MeasuredLog.rolling`); None: at rest.
    """
    total = drive.latency + delay
    origin = np.zeros((len(cut) - 1, 3))
    if (
        total >= 0.0 or len(t) < 2
    ):  # one row goes nowhere; late poses and late commands are the same in motion
        late = with_changes(drive, latency=max(total, 0.0))
        return replay(t, commands, cut, origin, drive=late, rolling=rolling, seen=seen).poses
    took = np.diff(t)
    left_out = took > AROUND  # rows between windows: none of these looks so far
    whole = len(cut) == 2 and not left_out.any()
    step = (t[-1] - t[0]) / (len(t) - 1) if whole else float(np.median(took))
    regular = np.abs(took - step) < REGULAR * step
    regular[cut[1:-1] - 1] = True
    regular |= left_out
    if not regular.all():
        return _ahead(t, commands, cut, with_changes(drive, latency=0.0), -total, seen, rolling)
    rows = int(np.ceil(-total / step))
    earlier = np.minimum(np.arange(len(t)) + rows, np.repeat(cut[1:], np.diff(cut)) - 1)
    given = np.ascontiguousarray(commands[earlier])
    shifted = with_changes(drive, latency=rows * step + total)
    there = None if seen is None else seen[earlier]
    return replay(t, given, cut, origin, drive=shifted, rolling=rolling, seen=there).poses


def recorded(t: FloatArray, path: FloatArray, cut: Rows, motion: Motion) -> FloatArray:
    """(rows, 3) poses of one robot as a tracker with another clock that averages has them.

    Args:
        t: (rows,) s.
        path: (rows, 3), each segment by itself.
        cut: (segments + 1,) first row of each segment, and the row count.
        motion: Whose `clock_rate`, `smear` and `pose_lag`.
    """
    if not motion.clock_rate and not motion.smear and not motion.pose_lag:
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
        if motion.pose_lag:
            from scipy.signal import lfilter  # half a second, and few trackers lag

            step = (at[-1] - at[0]) / (len(at) - 1)
            kept = float(np.exp(-step / motion.pose_lag))
            own[:] = own[0] + lfilter([1.0 - kept], [1.0, -kept], own - own[0], axis=0)
    return found


def wheel_turns(
    t: FloatArray,
    commands: FloatArray,
    cut: Rows,
    drive: Drive,
    delay: float,
    rolling: FloatArray | None = None,
) -> FloatArray:
    """(rows, 2) rad each wheel has turned by each row, from 0; arguments as `driven`."""
    turned = np.empty((len(t), 2))
    for side in (0, 1):
        # a body with one wheel of 1 m and an axle of 1 m turns as that wheel does
        radius = (0.0, 1.0) if side else (-1.0, 0.0)
        alone = with_changes(drive, wheel_radius=radius, axle=1.0, laws=())
        turned[:, side] = driven(t, commands, cut, alone, delay, rolling=rolling)[:, 2]
    return turned


def _ahead(
    t: FloatArray,
    commands: FloatArray,
    cut: Rows,
    drive: Drive,
    seconds: float,
    seen: FloatArray | None,
    rolling: FloatArray | None,
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
    there = None if seen is None else seen[given[taken]]
    path = replay(
        times, commands[given[taken]], starts, origin, drive=drive, rolling=rolling, seen=there
    ).poses
    return np.asarray(path[kept[later[len(t) :]]])


def _increasing(times: FloatArray, starts: Rows) -> tuple[FloatArray, Rows]:
    """Times without repetitions within a segment, and where each of the old ones is among them."""
    new = np.ones(len(times), dtype=bool)
    new[1:] = np.diff(times) > 1e-9
    new[starts[:-1]] = True
    return times[new], np.cumsum(new) - 1


def with_changes(drive: Drive, **changes: object) -> Drive:
    """The drive with some fields replaced; faster than `dataclasses.replace` in the fit's loop."""
    values = {name: getattr(drive, name) for name in Drive.__dataclass_fields__}
    return Drive(**{**values, **changes})

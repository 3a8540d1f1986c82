"""Where robots themselves stood, out of the poses that a tracker measured."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.driven import recorded
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.frames import Rows, Windows, motion, moved
from realitygap.models.log.measured import MeasuredLog


def poses_as_stood(
    log: MeasuredLog,
    model: PointModel,
    rows: Rows,
    poses: FloatArray,
    seen: Mapping[int, tuple[Motion, Motion]],
) -> FloatArray:
    """(rows, 3) the robots' own poses at rows of a log, out of measured ones; `seen` as `look`."""
    robot = log.frame["robot"].to_numpy(dtype=np.int64)[rows]
    since = log.t[rows] - log.t[0]
    result, late, lag = poses.copy(), np.zeros(len(rows)), 0.0
    for name, (healthy, found) in seen.items():
        mine = robot == name
        result[mine, :2] *= healthy.pose_scale / found.pose_scale
        yaw = poses[mine, 2] - (found.yaw_offset - healthy.yaw_offset)
        ahead, left = (b - a for a, b in zip(healthy.lever, found.lever, strict=True))
        c, s = np.cos(yaw), np.sin(yaw)
        result[mine, 0] -= c * ahead - s * left
        result[mine, 1] -= s * ahead + c * left
        result[mine, 2] = yaw
        rate = found.clock_rate - healthy.clock_rate
        late[mine] = found.pose_delay - healthy.pose_delay + rate * since[mine]
        lag = max(lag, found.pose_lag)
    if not late.any() and not lag:
        return result
    return moved(result, _since(log, model, rows, late, lag))


def _since(
    log: MeasuredLog, model: PointModel, rows: Rows, late: FloatArray, lag: float
) -> FloatArray:
    """(rows, 3) m, m, rad by which commands moved a robot from where a tracker has it, whose filter
    lags by `lag` s, to where it was `late` (rows,) s after a row."""
    path = replay_log(log, model.drive)
    shown = recorded(log.t, path, log.start, Motion(drive=model.drive, pose_lag=lag))[rows]
    there = path[rows].copy()
    segment = log.segment[rows]
    for k, (begin, end) in enumerate(pairwise(log.start.tolist())):
        mine = segment == k
        at, t = log.t[rows[mine]] + late[mine], log.t[begin:end]
        there[mine] = np.column_stack([np.interp(at, t, path[begin:end, i]) for i in range(3)])
    both = np.concatenate([shown, there])
    first = np.arange(len(rows))
    return motion(both, Windows(first, first + len(rows)))


def commanded(log: MeasuredLog, model: PointModel, rows: Rows) -> FloatArray:
    """(rows, 2) m/s and rad/s of the wheels as commanded."""
    drive = model.drive
    rim = log.commands[rows] * np.array(drive.wheel_radius)
    return np.column_stack([rim.mean(axis=1), (rim[:, 1] - rim[:, 0]) / drive.axle])

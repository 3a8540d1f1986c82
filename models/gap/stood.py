"""Where robots themselves stood, out of the poses that a tracker measured."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.log.frames import Rows
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
    velocity = _velocity(commanded(log, model, rows), poses)
    return _as_stood(poses, velocity, since, robot, seen)


def commanded(log: MeasuredLog, model: PointModel, rows: Rows) -> FloatArray:
    """(rows, 2) m/s and rad/s of the wheels as commanded."""
    drive = model.drive
    rim = log.commands[rows] * np.array(drive.wheel_radius)
    return np.column_stack([rim.mean(axis=1), (rim[:, 1] - rim[:, 0]) / drive.axle])


def _velocity(commanded: FloatArray, poses: FloatArray) -> FloatArray:
    """(rows, 3) m/s, m/s, rad/s in the arena's frame."""
    speed, yaw = commanded[:, 0], poses[:, 2]
    return np.column_stack([speed * np.cos(yaw), speed * np.sin(yaw), commanded[:, 1]])


def _as_stood(
    poses: FloatArray,
    velocity: FloatArray,
    since: FloatArray,
    robot: Rows,
    seen: Mapping[int, tuple[Motion, Motion]],
) -> FloatArray:
    """Poses of the robots themselves, where their markers are known to sit askew or be late."""
    result = poses.copy()
    for name, (healthy, found) in seen.items():
        mine = robot == name
        result[mine, :2] *= healthy.pose_scale / found.pose_scale
        yaw = poses[mine, 2] - (found.yaw_offset - healthy.yaw_offset)
        ahead, left = (b - a for a, b in zip(healthy.lever, found.lever, strict=True))
        c, s = np.cos(yaw), np.sin(yaw)
        result[mine, 0] -= c * ahead - s * left
        result[mine, 1] -= s * ahead + c * left
        result[mine, 2] = yaw
        late = found.pose_delay - healthy.pose_delay
        late = late + (found.clock_rate - healthy.clock_rate) * since[mine]
        result[mine] += late[:, None] * velocity[mine]
    return result

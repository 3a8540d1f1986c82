"""What a model file says of each robot of a log: where it should have been seen, what it believes.

An extension may concern some robots only, and the tracker as well as the wheels, so that a log is
replayed robot by robot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from realitygap.embedded_sim import PointModel, Tables
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.conditions import around
from realitygap.models.gap.driven import driven, recorded
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog


def motions(log: MeasuredLog, file: ModelFile, name: str = "model") -> dict[int, Motion]:
    """Each robot's believed motion, by id.

    Args:
        log: Whose robots.
        file: What is believed.
        name: What to call the file in an error.

    Raises:
        InputError: the extension concerns a robot that the log does not have.
    """
    robots = sorted({int(robot) for robot in log.segments["robot"]})
    if file.extension is not None:
        file.extension.check_robots(robots, name)
    return {robot: file.motion(robot) for robot in robots}


def replay_believed(log: MeasuredLog, believed: Mapping[int, Motion]) -> FloatArray:
    """(rows, 3) poses the tracker should have seen: the log's commands through each robot's motion.

    Each segment begins at the origin, but for a marker's offset.

    Raises:
        embedded_sim.Diverged: a pose left the finite numbers.
    """
    robot = log.segments["robot"].to_numpy(dtype=np.int64)
    alike: dict[Motion, list[int]] = {}
    for segment, one in enumerate(robot.tolist()):
        alike.setdefault(believed[one], []).append(segment)
    first = next(iter(alike))
    if len(alike) == 1 and first == Motion(drive=first.drive):
        return replay_log(log, first.drive)
    seen = np.empty((len(log.t), 3))
    for motion, segments in alike.items():
        rows, poses = replay_segments(log, segments, motion)
        seen[rows] = poses
    return seen


def replay_segments(
    log: MeasuredLog, segments: Sequence[int], motion: Motion
) -> tuple[Rows, FloatArray]:
    """Rows of some segments, and (those rows, 3) poses the tracker should have seen, as above."""
    rows = np.concatenate([np.arange(*log.start[k : k + 2]) for k in segments])
    cut = np.concatenate([[0], np.cumsum([log.start[k + 1] - log.start[k] for k in segments])])
    commands = np.ascontiguousarray(log.commands[rows])
    late = motion.motor_delay + motion.pose_delay
    whole = around(log, motion.drive)
    seen = None if whole is None else whole[rows]
    rolling = None if log.rolling is None else log.rolling[list(segments)]
    path = driven(log.t[rows], commands, cut, motion.drive, late, seen, rolling)
    path = recorded(log.t[rows], path, cut, motion)
    return rows, as_seen(path, motion)


def as_seen(poses: FloatArray, motion: Motion) -> FloatArray:
    """(rows, 3) poses as the tracker sees a robot whose marker is off."""
    ahead, left = motion.lever
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    offset = [c * ahead - s * left, s * ahead + c * left, np.full(len(c), motion.yaw_offset)]
    seen = np.asarray(poses + np.column_stack(offset))
    seen[:, :2] *= motion.pose_scale
    return seen


def own_models(log: MeasuredLog, file: ModelFile, tables: Tables | None) -> dict[int, PointModel]:
    """Point models of the robots that the extension sets apart."""
    apart = [] if file.extension is None else file.extension.robots
    present = {int(robot) for robot in log.segments["robot"]}
    return {r: file.point_model(tables, robot=r) for r in apart if r in present}

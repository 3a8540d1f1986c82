"""UTIAS multi-robot logs (Leung, Halpern, Barfoot, Liu, Int. J. Robot. Res. 2011): five iRobot
Creates.

A directory holds, per robot N, `RobotN_Odometry.dat` (time [s], forward velocity [m/s], angular
velocity [rad/s]: the velocities commanded, at 60-73 Hz) and `RobotN_Groundtruth.dat` (time [s], x
[m], y [m], heading [rad] from a Vicon system at about 100 Hz), both on one clock. Lines that start
with `#` are remarks. Commands and poses are joined on time (`log.formats.joined`).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.formats.joined import join, latest
from realitygap.models.log.formats.numbers import read_numbers

COMMANDS, POSES = "Robot{}_Odometry.dat", "Robot{}_Groundtruth.dat"


def read_mrclam(directory: Path) -> pd.DataFrame:
    """Every robot of a directory as one measured-log table, the run named after the directory.

    Raises:
        InputError: no such files, or a file that does not hold its columns.
    """
    found = [
        re.fullmatch(r"Robot(\d+)_Odometry\.dat", path.name) for path in directory.glob("*.dat")
    ]
    robots = sorted(int(match[1]) for match in found if match)
    if not robots:
        raise InputError(
            "SOURCE", directory, "a directory with RobotN_Odometry.dat and RobotN_Groundtruth.dat"
        )
    return pd.concat([_robot(directory, robot) for robot in robots], ignore_index=True)


def _robot(directory: Path, robot: int) -> pd.DataFrame:
    """One robot's rows."""
    commands = _numbers(directory / COMMANDS.format(robot), 3)
    poses = _numbers(directory / POSES.format(robot), 4)
    command_t, command = latest(commands[:, 0], commands[:, 1:])
    pose_t, pose = latest(poses[:, 0], poses[:, 1:])
    t, held, at = join(command_t, command, pose_t, pose)
    columns = {"run": directory.name, "robot": robot, "t": t}
    columns |= dict(zip(("x", "y", "yaw"), at.T, strict=True))
    columns |= dict(zip(("cmd_v", "cmd_omega"), held.T, strict=True))
    return pd.DataFrame(columns)


def _numbers(path: Path, columns: int) -> FloatArray:
    """A file of numbers between white space, in order of time."""
    values = read_numbers(path, columns, "both files of each robot")
    return values[np.argsort(values[:, 0], kind="stable")]

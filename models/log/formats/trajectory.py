"""Trajectories as evaluations of odometry keep them, TUM and EuRoC, with a table of commands.

TUM: a line per pose, `timestamp tx ty tz qx qy qz qw`, in s and m, between blanks. EuRoC: CSV with
`timestamp [ns], x, y, z, qw, qx, qy, qz` first in each line; `data.csv`, or a directory above it.
Lines that start with `#` are remarks. Both hold the poses of one robot, so its commands come from a
file of their own, by a map without x, y and yaw, or by a guess.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.formats.guess import guess
from realitygap.models.log.formats.numbers import read_numbers
from realitygap.models.log.formats.streams import merged
from realitygap.models.log.formats.tabular import Asked, Read, by_any_map
from realitygap.models.log.formats.units import heading
from realitygap.models.log.measured import read_table
from realitygap.models.log.schema import POSE

TUM = "poses as timestamp tx ty tz qx qy qz qw between blanks, a line each"
EUROC = "poses as timestamp [ns], x, y, z, qw, qx, qy, qz, a line each"


def read_tum(path: Path, asked: Asked) -> Read:
    """A TUM trajectory and its commands.

    Raises:
        InputError: a file cannot be read, or there are no commands at the same time.
    """
    values = read_numbers(path, 8, TUM)
    return _with_commands(path, values[:, 0], values[:, 1:4], values[:, 4:], asked)


def read_euroc(path: Path, asked: Asked) -> Read:
    """A EuRoC ground truth and its commands; refusals as `read_tum`."""
    source = path
    if path.is_dir():
        found = sorted(path.glob("**/state_groundtruth_estimate*/data.csv")) or [path / "data.csv"]
        if len(found) > 1:
            raise InputError("SOURCE", f"{len(found)} trajectories in {path}", "one of them")
        source = found[0]
    values = read_numbers(source, 8, EUROC, delimiter=",")
    turned = values[:, [5, 6, 7, 4]]
    return _with_commands(source, 1e-9 * values[:, 0], values[:, 1:4], turned, asked)


def _with_commands(
    path: Path, t: FloatArray, places: FloatArray, turned: FloatArray, asked: Asked
) -> Read:
    """Poses seen from above, and the commands at their time."""
    commands = asked.commands
    if commands is None:
        expected = "a table of the robot's commands: the trajectory holds poses alone"
        raise InputError("--commands", "nothing", expected)
    yaw = heading(turned, f"{path.name}: quaternion")
    columns = dict(zip(POSE, (places[:, 0], places[:, 1], yaw), strict=True))
    seen = pd.DataFrame({"t": t, **columns})
    raw = read_table(commands)
    if asked.map is None and not asked.guessed:
        text = guess(raw, commands, drive=asked.drive, fastest=asked.fastest, seen=seen)
        asked = replace(asked, guessed=text)
    told, text = by_any_map(raw, commands, asked)
    if told["robot"].nunique() > 1:
        said = f"commands of {told['robot'].nunique()} robots"
        raise InputError("--commands", said, "of the one whose trajectory it is")
    both = [told.drop(columns=[n for n in POSE if n in told]), seen]
    return Read(merged(both, commands.name), text)

"""`next_experiment` of a diagnosis, as it is read back: whatever somebody has made of the file.

Its commands also go into a bag of ROS 2: a topic of `geometry_msgs/Twist` for each robot.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from pydantic import Field, field_validator

from realitygap.embedded_sim import Drive, InputError
from realitygap.embedded_sim.errors import nearest
from realitygap.embedded_sim.probes import MENU
from realitygap.models.log.files import Finite, Refused
from realitygap.models.log.formats.bag import TWIST
from realitygap.studies.plumbing.rooms import scratch

Length = Annotated[float, Field(ge=-1e6, le=1e6)]
"""m; no lab's frame is larger than 1000 km."""
Names = Annotated[tuple[int | str, ...], Field(min_length=1, max_length=100)]
"""Robots; more are in no log whose cause is named."""


class RoomTable(Finite):
    """`ground`: the circle that a manoeuvre stays in."""

    x: Length
    y: Length
    radius: Annotated[float, Field(gt=0.0, le=1e6)]
    walled: bool


class RivalTable(Finite):
    """One of `rivals`."""

    name: str
    word: str | None
    values: Mapping[str, float]


class ExpectedTable(Finite):
    """One of `expected`."""

    robot: int | str | None
    t_start: float
    t_end: float
    channel: str
    unit: str
    values: Mapping[str, float]
    apart: float


class PlanTable(Finite):
    """`plan`."""

    step: Annotated[float, Field(ge=1e-3, le=10.0)]
    """s: 1000 rows a second are more than any tracker's, a manoeuvre has parts shorter than 10."""
    ground: RoomTable
    rivals: tuple[RivalTable, ...]
    expected: tuple[ExpectedTable, ...]


class FollowingTable(Finite):
    """`next_experiment`."""

    name: str
    separates: tuple[str, ...]
    does: str
    separation: float
    lamp: str
    needs: tuple[str, ...]
    menu: tuple[Mapping[str, Any], ...]
    commands: tuple[str, ...]
    plan: PlanTable

    @field_validator("name")
    @classmethod
    def _known(cls, name: str) -> str:
        """Refuse what is not on the menu."""
        if name not in MENU:
            raise Refused("", repr(name), nearest(name, MENU))
        return name


class ProposingTable(Finite):
    """What is read of a diagnosis that proposes a manoeuvre."""

    robots: Names
    next_experiment: FollowingTable


def topics_of(robots: Sequence[int | str]) -> list[str]:
    """Each robot's topic: /cmd_vel where there is one robot, else /robot_3/cmd_vel or by name."""
    if len(robots) == 1:
        return ["/cmd_vel"]
    plain = [re.sub(r"[^A-Za-z0-9_]", "_", str(robot)) for robot in robots]
    if len(set(plain)) < len(plain):  # names that only differ in letters that ROS does not have
        plain = [str(k) for k in range(len(robots))]
    return [f"/{name if name[:1].isalpha() else f'robot_{name}'}/cmd_vel" for name in plain]


def write_twists(path: Path, commands: pd.DataFrame, drive: Drive) -> None:
    """Write the bag: one file of MCAP by its ending, else into a directory that is there.

    Args:
        path: The file or the directory.
        commands: Columns `t`, `robot`, `cmd_left`, `cmd_right`.
        drive: The geometry by which the robots turn body commands into wheel speeds.

    Raises:
        InputError: the extra [ros] is not installed.
    """
    if find_spec("rosbags") is None:
        expected = "the extra [ros] to be installed: pip install 'reality-gap[ros]'"
        raise InputError("--out", path.name, expected)
    from rosbags.rosbag2 import StoragePlugin, Writer

    one = path.suffix == ".mcap"
    with scratch() as room:
        plugin = StoragePlugin.MCAP if one else StoragePlugin.SQLITE3
        bag = room / path.stem
        with Writer(bag, version=9, storage_plugin=plugin) as writer:
            _say(writer, commands, drive)
        for part in sorted(bag.iterdir()):
            if one and part.suffix == path.suffix:
                path.write_bytes(part.read_bytes())
            elif not one:
                (path / part.name).write_bytes(part.read_bytes())


def _say(writer: Any, commands: pd.DataFrame, drive: Drive) -> None:
    """Every robot's commands, in order of time."""
    from rosbags.typesys import Stores, get_typestore

    store: Any = get_typestore(Stores.ROS2_HUMBLE)
    twist, vector = (store.types[name] for name in (TWIST, "geometry_msgs/msg/Vector3"))
    robots = list(dict.fromkeys(commands["robot"]))
    topics = {
        robot: writer.add_connection(topic, TWIST, typestore=store)
        for robot, topic in zip(robots, topics_of(robots), strict=True)
    }
    left, right = (
        commands[name].to_numpy() * radius
        for name, radius in zip(("cmd_left", "cmd_right"), drive.wheel_radius, strict=True)
    )
    speed, rate = 0.5 * (left + right), (right - left) / drive.axle
    rows = zip(commands["t"], commands["robot"], speed.tolist(), rate.tolist(), strict=True)
    for t, robot, v, omega in rows:
        message = twist(linear=vector(x=v, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=omega))
        content = bytes(store.serialize_cdr(message, TWIST))
        writer.write(topics[robot], round(1e9 * t), content)

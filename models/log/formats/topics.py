"""Which topic of a bag is what: the map of a bag, and a guess at it.

clock = "received"                # of who recorded; or "stamped": of whoever sent a message

[topics]                          # one robot
commands = "/cmd_vel"
poses = { topic = "/tf", frame = "base_link", in = "map" }     # or the name of a topic
wheels = { topic = "/joint_states", left = "wheel_left_joint", right = "wheel_right_joint" }
odometry = "/odom"
gyro = "/imu"

[robots.tb3_0]                    # or several, by name, with the same keys
commands = "/tb3_0/cmd_vel"
poses = "/vrpn/tb3_0/pose"
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

import tomli_w
from pydantic import Field, model_validator

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.errors import nearest
from realitygap.models.log.files import Refused, Table, checked
from realitygap.models.log.formats.bag import (
    IMU,
    JOINTS,
    ODOMETRY,
    POSE,
    POSE_COVARIANCE,
    TF,
    TRANSFORM,
    TWIST,
    TWIST_STAMPED,
    Bag,
    Heard,
    Topic,
    hear,
)
from realitygap.models.log.opened import toml_values

KINDS: dict[str, tuple[str, ...]] = {
    "commands": (TWIST, TWIST_STAMPED),
    "poses": (POSE, POSE_COVARIANCE, ODOMETRY, TRANSFORM, *TF),
    "wheels": (JOINTS,),
    "odometry": (ODOMETRY,),
    "gyro": (IMU,),
}
"""Types of messages that each key of a map may name."""
GOALS = ("goal", "target", "initial", "plan", "setpoint", "desired")
"""Words of poses that are wanted, not measured."""
OUTER = ("map", "world", "mocap", "optitrack", "vicon")
"""Frames that do not move with a robot's odometry, the likeliest first."""
INNER = ("base_footprint", "base_link")
"""Frames of a robot's body, the likeliest first."""
OWN = "# The robot's own odometry: a wrong wheel does not show in it. Better: a tracker's poses."


class Frames(Table):
    """A pose out of transforms."""

    topic: str
    frame: str
    """Of the robot's body."""
    within: Annotated[str, Field(alias="in")]
    """In which its pose is told."""


class Wheels(Table):
    """Joints of the two wheels."""

    topic: str
    left: str
    right: str


class RobotTopics(Table):
    """The topics of one robot."""

    commands: str
    poses: str | Frames
    wheels: Wheels | None = None
    odometry: str | None = None
    gyro: str | None = None

    @property
    def named(self) -> dict[str, str]:
        """Every key that names a topic, and the topic."""
        poses = self.poses if isinstance(self.poses, str) else self.poses.topic
        found = {"commands": self.commands, "poses": poses}
        found |= {} if self.wheels is None else {"wheels": self.wheels.topic}
        found |= {} if self.odometry is None else {"odometry": self.odometry}
        return found | ({} if self.gyro is None else {"gyro": self.gyro})


class BagMap(Table):
    """A whole map."""

    clock: Literal["received", "stamped"] = "received"
    topics: RobotTopics | None = None
    robots: dict[str, RobotTopics] = {}  # noqa: RUF012 - pydantic copies it

    @model_validator(mode="after")
    def _some(self) -> BagMap:
        """Refuse a map of nothing, or two kinds of map in one."""
        if (self.topics is None) == (not self.robots):
            got = "neither" if self.topics is None else "both"
            raise Refused("", got, "[topics] of one robot, or a table [robots.NAME] of each")
        return self

    def check(self, bag: Bag, name: str) -> None:
        """Refuse topics that a bag does not have, or of another type.

        Raises:
            InputError: the first of them.
        """
        every = {"topics": self.topics} if self.topics else {}
        every |= {f"robots.{robot}": one for robot, one in self.robots.items()}
        for where, one in every.items():
            for key, topic in one.named.items():
                kind, field = bag.type_of(topic), f"{name}: {where}.{key}"
                fit = [known.name for known in bag.topics if known.type in KINDS[key]]
                if not kind:
                    raise InputError(field, f"no topic {topic}", nearest(topic, fit))
                if kind not in KINDS[key]:
                    expected = f"{' or '.join(KINDS[key])}: {nearest(topic, fit)}"
                    raise InputError(field, f"{topic} of type {kind}", expected)


def read_bag_map(path: Path) -> BagMap:
    """Read and check a map.

    Raises:
        InputError: no such file, broken TOML, or unknown or missing keys.
    """
    return checked(
        BagMap, toml_values(path, "a map of topics (TOML)", field="--map"), path, "a map of topics"
    )


def guess_topics(bag: Bag) -> str:
    """The text of a map for a bag, where its topics leave no choice.

    Raises:
        InputError: there are no commands or poses, or more than one that could be them.
    """
    told = [one for one in bag.heard if one.type in KINDS["commands"]]
    if not told:
        raise InputError(
            str(bag.path), _listed(bag.topics), f"a topic of {TWIST} or {TWIST_STAMPED}"
        )
    robots = sorted({_space(one.name) for one in told})
    named = [one.name for one in bag.heard if one.type in (JOINTS, *TF)]
    heard = hear(bag, named)
    head = [f"# Guessed from the topics of {bag.path.name}. Correct it, and give it with --map."]
    if len(robots) == 1:
        return "\n".join([*head, "", *_robot("topics", "", bag, heard)])
    tables = [
        line
        for robot in robots
        for line in _robot(f"robots.{_key(robot, robots)}", robot, bag, heard)
    ]
    return "\n".join([*head, "", *tables])


def _robot(table: str, robot: str, bag: Bag, heard: Heard) -> list[str]:
    """The lines of one robot; `robot` is its name space, empty: it is the only one."""
    own = [one for one in bag.heard if not robot or _last(robot) in one.name.split("/")]
    told = _only([t for t in own if t.type in KINDS["commands"]], "commands", "cmd_vel", bag)
    lines = [f"[{table}]", f"commands = {_quoted(told.name)}"]
    line, used = _poses(own, robot, bag, heard)
    lines += line
    odometry = [t for t in own if t.type == ODOMETRY and t.name != used]
    if len(odometry) == 1:
        lines.append(f"odometry = {_quoted(odometry[0].name)}")
    inertial = [t for t in own if t.type == IMU]
    if len(inertial) == 1:
        lines.append(f"gyro = {_quoted(inertial[0].name)}")
    joints = [key for key in heard.keys if len(key) == 2 and key[0] in {t.name for t in own}]
    sides = {side: [k for k in joints if side in k[1].lower()] for side in ("left", "right")}
    if all(len(found) == 1 for found in sides.values()):
        (left,), (right,) = sides["left"], sides["right"]
        if left[0] == right[0]:
            names = f"left = {_quoted(left[1])}, right = {_quoted(right[1])}"
            lines.append(f"wheels = {{ topic = {_quoted(left[0])}, {names} }}")
    return [*lines, ""]


def _poses(own: Sequence[Topic], robot: str, bag: Bag, heard: Heard) -> tuple[list[str], str]:
    """The line of the poses, and their topic: a tracker's, a map's, or else odometry."""
    seen = [t for t in own if t.type in (POSE, TRANSFORM, POSE_COVARIANCE)]
    seen = [t for t in seen if not any(word in t.name.lower() for word in GOALS)]
    for kind in (POSE, TRANSFORM):
        if tracked := [t for t in seen if t.type == kind]:
            one = _only(tracked, "poses", "pose", bag)
            return [f"poses = {_quoted(one.name)}"], one.name
    links = [key for key in heard.keys if len(key) == 3]
    frames = {frame for key in links for frame in key[1:] if not robot or _last(robot) in frame}
    bodies = [f for name in INNER for f in sorted(frames) if f.split("/")[-1] == name]
    outer = [f for name in OUTER for f in {key[1] for key in links} if f.split("/")[-1] == name]
    if bodies and outer:
        topic = next(key[0] for key in links if key[1] == outer[0])
        content = (
            f"topic = {_quoted(topic)}, frame = {_quoted(bodies[0])}, in = {_quoted(outer[0])}"
        )
        return [f"poses = {{ {content} }}"], topic
    odometry = [t for t in own if t.type == ODOMETRY]
    if truth := [t for t in odometry if "truth" in t.name.lower()]:
        return [f"poses = {_quoted(truth[0].name)}"], truth[0].name
    if amcl := [t for t in seen if t.type == POSE_COVARIANCE and not odometry]:
        return [f"poses = {_quoted(amcl[0].name)}"], amcl[0].name
    if odometry:
        one = _only(odometry, "poses", "odom", bag)
        return [OWN, f"poses = {_quoted(one.name)}"], one.name
    raise InputError(str(bag.path), _listed(bag.topics), f"a topic of poses{_of(robot)}, or --map")


def _only(found: Sequence[Topic], key: str, usual: str, bag: Bag) -> Topic:
    """The one topic, or the one of the usual name."""
    usually = [one for one in found if one.name.rsplit("/", 1)[-1] == usual]
    for few in (found, usually):
        if len(few) == 1:
            return few[0]
    said = f"{len(found)} topics that could be {key}: {', '.join(one.name for one in found)}"
    raise InputError(str(bag.path), said, "one of them, named in a map (--map)")


def _space(topic: str) -> str:
    """The name space of a topic without the parts that say what it is."""
    return topic.strip("/").rpartition("/")[0]


def _last(space: str) -> str:
    return space.rsplit("/", 1)[-1]


def _of(robot: str) -> str:
    return f" of {robot}" if robot else ""


def _listed(topics: Sequence[Topic]) -> str:
    each = (f"{one.name} ({one.type}{'' if one.messages else ', silent'})" for one in topics)
    return "topics " + (", ".join(each) or "none")


def _quoted(text: str) -> str:
    return tomli_w.dumps({"a": text}).removeprefix("a = ").rstrip("\n")


def _key(robot: str, robots: Sequence[str]) -> str:
    """What a robot is called: the last part of its name space, if no other has the same."""
    short = [_last(one) for one in robots]
    return _quoted((_last(robot) if short.count(_last(robot)) == 1 else robot) or "unnamed")


def describe(topics: Sequence[Topic]) -> list[Mapping[str, str | int]]:
    """What each topic could be: rows of `topic`, `type`, `messages`, `could_be`."""
    return [
        {
            "topic": one.name,
            "type": one.type,
            "messages": one.messages,
            "could_be": ", ".join(
                key for key, types in KINDS.items() if one.messages and one.type in types
            ),
        }
        for one in topics
    ]

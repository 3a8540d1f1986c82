"""Bags of ROS 1 and ROS 2 and MCAP files, opened with care: what topics there are, what they said.

Messages are read by the definitions that come with the library, never by those in a bag: only
standard types are asked for, and a bag from outside defines nothing here. The library, `rosbags`,
is the extra [ros].
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.opened import opened, parsing

EXPECTED = "a bag: a ROS 2 bag's directory, .db3, .mcap, or a ROS 1 .bag"
MOST_BYTES = 2**36
"""bytes of a bag's file. Our choice: cameras fill 64 GB in hours; poses and commands never do."""
MOST_META = 2**22
"""bytes of `metadata.yaml`: thousands of topics."""
MOST_MESSAGES = 5_000_000
"""Messages of the topics that are read. Our choice: ten robots at 100 Hz for more than an hour."""

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"
ODOMETRY = "nav_msgs/msg/Odometry"
POSE = "geometry_msgs/msg/PoseStamped"
POSE_COVARIANCE = "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORM = "geometry_msgs/msg/TransformStamped"
TF = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
JOINTS = "sensor_msgs/msg/JointState"
IMU = "sensor_msgs/msg/Imu"
READ = (TWIST, TWIST_STAMPED, ODOMETRY, POSE, POSE_COVARIANCE, TRANSFORM, *TF, JOINTS, IMU)
"""Types of messages that are read."""


class Topic(NamedTuple):
    """One topic of a bag."""

    name: str
    type: str
    messages: int


class Said(NamedTuple):
    """What one topic said, or one link or joint of it."""

    received: FloatArray
    """(messages,) s since 1970, by the clock of whoever recorded."""
    stamped: FloatArray
    """(messages,) s, by the clock of whoever sent it; NaN where a message has no stamp."""
    values: FloatArray
    """(messages, numbers)."""


@contextmanager
def open_bag(path: Path) -> Iterator[Bag]:
    """A bag for reading.

    Raises:
        InputError: the library is not installed, or it is no bag, is damaged or too large.
    """
    if find_spec("rosbags") is None:
        expected = "the extra [ros] to be installed: pip install 'reality-gap[ros]'"
        raise InputError("SOURCE", path, expected)
    ours = path.suffix == ".bag"
    _check_files(path)
    from rosbags import rosbag1, rosbag2

    with parsing(str(path), EXPECTED):
        reader: Any = rosbag1.Reader(path) if ours else rosbag2.Reader(path)
        reader.open()
    try:
        yield Bag(path, reader, first=ours)
    finally:
        with parsing(str(path), EXPECTED):
            reader.close()


def _check_files(path: Path) -> None:
    """Refuse pipes, devices and what is too large before the library opens it."""
    if not path.is_dir():
        if path.suffix not in (".bag", ".db3", ".mcap") and path.exists():
            raise InputError("SOURCE", path, EXPECTED)
        with opened(path, EXPECTED, most=MOST_BYTES):
            return
    with opened(path / "metadata.yaml", EXPECTED, most=MOST_META) as file:
        text = file.read(MOST_META)
    if b"compression_mode: FILE" in text or b"compression_mode: file" in text:
        expected = "a bag whose files are not packed as a whole (ros2 bag convert)"
        raise InputError("SOURCE", path, expected)
    for part in sorted(path.iterdir()):
        with opened(part, EXPECTED, most=MOST_BYTES):
            pass


class Bag:
    """An open bag."""

    def __init__(self, path: Path, reader: Any, *, first: bool) -> None:
        self.path, self._reader, self._first = path, reader, first
        self._types = _typestore(first)
        with parsing(str(path), EXPECTED):
            self.topics = sorted(
                {
                    Topic(str(one.topic), str(one.msgtype), int(one.msgcount))
                    for one in reader.connections
                }
            )

    @property
    def heard(self) -> list[Topic]:
        """The topics that something was said on."""
        return [one for one in self.topics if one.messages]

    def type_of(self, name: str) -> str:
        """The type of a topic; empty: there is no such topic."""
        return next((one.type for one in self.topics if one.name == name), "")

    def messages(self, names: Collection[str]) -> Iterator[tuple[str, float, Any]]:
        """Topic, s since 1970 and message, in the order of the bag.

        Raises:
            InputError: a message is damaged, or there are too many.
        """
        asked = [c for c in self._reader.connections if c.topic in names and c.msgtype in READ]
        if not asked:
            return
        read = self._types.deserialize_ros1 if self._first else self._types.deserialize_cdr
        source, number = self._reader.messages(connections=asked), 0
        while True:
            with parsing(str(self.path), EXPECTED):
                found = next(source, None)
                if found is None:
                    return
                connection, nanoseconds, raw = found
                message = read(raw, connection.msgtype)
            number += 1
            if number > MOST_MESSAGES:
                expected = "a shorter bag: give it in parts"
                raise InputError(str(self.path), f"more than {MOST_MESSAGES} messages", expected)
            yield str(connection.topic), 1e-9 * nanoseconds, message


def _typestore(first: bool) -> Any:
    """The library's own definitions."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    if not first:
        return get_typestore(Stores.ROS2_HUMBLE)
    types = get_typestore(Stores.ROS1_NOETIC)
    for name in TF:
        types.register(get_types_from_msg(f"{TRANSFORM.replace('/msg', '')}[] transforms", name))
    return types


class Heard:
    """Collects what topics say."""

    def __init__(self) -> None:
        self._rows: dict[tuple[str, ...], list[tuple[float, ...]]] = {}

    def add(self, key: tuple[str, ...], received: float, message: Any, values: Any) -> None:
        """Some numbers of a message, under a key; `message` has the stamp, or None."""
        stamp = np.nan if message is None else _stamp(message.header)
        self._rows.setdefault(key, []).append((received, stamp, *values))

    @property
    def keys(self) -> list[tuple[str, ...]]:
        """All keys, in order."""
        return sorted(self._rows)

    def said(self, key: tuple[str, ...]) -> Said | None:
        """All of a key; None: nothing."""
        rows = self._rows.get(key)
        if not rows:
            return None
        table = np.array(rows, dtype=float)
        return Said(table[:, 0], table[:, 1], table[:, 2:])


def hear(bag: Bag, names: Collection[str]) -> Heard:
    """Everything that is read of some topics.

    Keys: `(topic,)` of twists (v, omega), poses and odometry (x, y, z and a quaternion), and of
    inertial units (turn rate); `(topic, parent, child)` of transforms; `(topic, joint)` of joints
    (speed, angle; NaN where not given).
    """
    heard = Heard()
    for topic, received, message in bag.messages(names):
        kind = message.__msgtype__
        key = (topic,)
        if kind == TWIST:
            heard.add(key, received, None, (message.linear.x, message.angular.z))
        elif kind == TWIST_STAMPED:
            twist = message.twist
            heard.add(key, received, message, (twist.linear.x, twist.angular.z))
        elif kind == POSE:
            heard.add(key, received, message, _numbers(message.pose))
        elif kind in (ODOMETRY, POSE_COVARIANCE):
            heard.add(key, received, message, _numbers(message.pose.pose))
        elif kind == IMU:
            heard.add(key, received, message, (message.angular_velocity.z,))
        elif kind == JOINTS:
            for k, joint in enumerate(message.name):
                values = (_at(message.velocity, k), _at(message.position, k))
                heard.add((topic, str(joint)), received, message, values)
        else:
            for one in [message] if kind == TRANSFORM else message.transforms:
                link = (topic, one.header.frame_id.lstrip("/"), one.child_frame_id.lstrip("/"))
                place = one.transform.translation, one.transform.rotation
                heard.add(link, received, one, _placed(*place))
    return heard


def _stamp(header: Any) -> float:
    return float(header.stamp.sec + 1e-9 * header.stamp.nanosec)


def _numbers(pose: Any) -> tuple[float, ...]:
    return _placed(pose.position, pose.orientation)


def _placed(at: Any, turned: Any) -> tuple[float, ...]:
    return (at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w)


def _at(values: Any, k: int) -> float:
    return float(values[k]) if k < len(values) else np.nan

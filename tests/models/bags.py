"""Bags as robots record them, written by the library that labs use."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

EPOCH = 1_700_000_000.0
"""s since 1970 when the recordings begin."""
LATE = 0.25
"""s by which the clock of whoever sends is ahead of that of whoever records."""
KINDS = ("ros2", "mcap", "ros1")
Message = tuple[float, str, str, Any]
"""s, topic, type, and a function of the types that makes the message."""


class Made:
    """Messages of one kind of bag."""

    def __init__(self, store: Any, *, first: bool) -> None:
        self._types, self._first = store.types, first

    def __call__(self, name: str, /, **fields: Any) -> Any:
        return self._types[name](**fields)

    def header(self, t: float, frame: str = "map") -> Any:
        whole = int(t)
        stamp = self("builtin_interfaces/msg/Time", sec=whole, nanosec=round((t - whole) * 1e9))
        more = {"seq": 0} if self._first else {}
        return self("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **more)

    def vector(self, x: float = 0.0, y: float = 0.0, z: float = 0.0, kind: str = "Vector3") -> Any:
        return self(f"geometry_msgs/msg/{kind}", x=float(x), y=float(y), z=float(z))

    def turned(self, yaw: float) -> Any:
        fields = {"x": 0.0, "y": 0.0, "z": float(np.sin(yaw / 2)), "w": float(np.cos(yaw / 2))}
        return self("geometry_msgs/msg/Quaternion", **fields)

    def twist(self, v: float, omega: float) -> Any:
        return self("geometry_msgs/msg/Twist", linear=self.vector(v), angular=self.vector(z=omega))

    def pose(self, x: float, y: float, yaw: float) -> Any:
        at = self.vector(x, y, kind="Point")
        return self("geometry_msgs/msg/Pose", position=at, orientation=self.turned(yaw))

    def stamped(self, t: float, x: float, y: float, yaw: float) -> Any:
        pose = self.pose(x, y, yaw)
        return self("geometry_msgs/msg/PoseStamped", header=self.header(t), pose=pose)

    def odometry(self, t: float, x: float, y: float, yaw: float) -> Any:
        pose, nothing = self.pose(x, y, yaw), np.zeros(36)
        with_pose = self("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=nothing)
        with_twist = self(
            "geometry_msgs/msg/TwistWithCovariance", twist=self.twist(0, 0), covariance=nothing
        )
        return self(
            "nav_msgs/msg/Odometry",
            header=self.header(t, "odom"),
            child_frame_id="base_link",
            pose=with_pose,
            twist=with_twist,
        )

    def transform(self, t: float, parent: str, child: str, x: float, y: float, yaw: float) -> Any:
        place = self(
            "geometry_msgs/msg/Transform", translation=self.vector(x, y), rotation=self.turned(yaw)
        )
        return self(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(t, parent),
            child_frame_id=child,
            transform=place,
        )

    def tf(self, *transforms: Any) -> Any:
        return self("tf2_msgs/msg/TFMessage", transforms=list(transforms))

    def joints(self, t: float, names: list[str], angles: Any, speeds: Any) -> Any:
        return self(
            "sensor_msgs/msg/JointState",
            header=self.header(t),
            name=names,
            position=np.array(angles, dtype=float),
            velocity=np.array(speeds, dtype=float),
            effort=np.array([]),
        )

    def imu(self, t: float, rate: float) -> Any:
        nothing = np.zeros(9)
        return self(
            "sensor_msgs/msg/Imu",
            header=self.header(t),
            orientation=self.turned(0.0),
            orientation_covariance=nothing,
            angular_velocity=self.vector(z=rate),
            angular_velocity_covariance=nothing,
            linear_acceleration=self.vector(),
            linear_acceleration_covariance=nothing,
        )


Say = Callable[[Made], Iterator[Message]]


def write_bag(path: Path, kind: str, say: Say, silent: Mapping[str, str] | None = None) -> Path:
    """A bag of messages, and of topics with types that nobody spoke on; `path` without an ending.
    What was written."""
    from rosbags import rosbag1, rosbag2
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    first = kind == "ros1"
    store = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
    writer: Any
    if first:
        text = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(text, "tf2_msgs/msg/TFMessage"))
        path = path.with_suffix(".bag")
        writer = rosbag1.Writer(path)
    else:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    pack = store.serialize_ros1 if first else store.serialize_cdr
    messages = sorted(say(Made(store, first=first)), key=lambda one: one[0])
    with writer:
        connections: dict[str, Any] = {}
        for topic, name in (silent or {}).items():
            writer.add_connection(topic, name, typestore=store)
        for t, topic, name, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=store)
            nanoseconds = round((EPOCH + t) * 1e9)
            writer.write(connections[topic], nanoseconds, bytes(pack(message, name)))
    return path


def commands(frame: pd.DataFrame, topic: str = "/cmd_vel", *, stamped: bool = False) -> Say:
    """Body commands, sent only where they change."""

    def say(made: Made) -> Iterator[Message]:
        told = frame[["cmd_v", "cmd_omega"]]
        changed = (told != told.shift()).any(axis=1)
        changed.iloc[-1] = True
        for t, v, omega in frame.loc[changed, ["t", "cmd_v", "cmd_omega"]].itertuples(index=False):
            twist = made.twist(v, omega)
            if stamped:
                name = "geometry_msgs/msg/TwistStamped"
                header = made.header(EPOCH + t + LATE)
                yield t, topic, name, made(name, header=header, twist=twist)
            else:
                yield t, topic, "geometry_msgs/msg/Twist", twist

    return say


def poses(frame: pd.DataFrame, topic: str, how: str = "stamped") -> Say:
    """Poses as PoseStamped (`stamped`), `odometry`, or `transform`."""
    kinds = {
        "stamped": "geometry_msgs/msg/PoseStamped",
        "odometry": "nav_msgs/msg/Odometry",
        "transform": "geometry_msgs/msg/TransformStamped",
    }

    def say(made: Made) -> Iterator[Message]:
        for t, x, y, yaw in frame[["t", "x", "y", "yaw"]].itertuples(index=False):
            sent = EPOCH + t + LATE
            if how == "transform":
                message = made.transform(sent, "vicon/world", "vicon/robot", x, y, yaw)
            else:
                message = getattr(made, how)(sent, x, y, yaw)
            yield t, topic, kinds[how], message

    return say


def together(*parts: Say) -> Say:
    """All of several."""
    return lambda made: (one for part in parts for one in part(made))

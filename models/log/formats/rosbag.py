"""Robots in a bag as one measured-log table."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.files import checked
from realitygap.models.log.formats.bag import Heard, Said, hear, open_bag
from realitygap.models.log.formats.joined import latest
from realitygap.models.log.formats.streams import merged
from realitygap.models.log.formats.tabular import Asked, Read
from realitygap.models.log.formats.topics import (
    BagMap,
    Frames,
    RobotTopics,
    describe,
    guess_topics,
    read_bag_map,
)
from realitygap.models.log.formats.units import ANGLES, heading
from realitygap.models.log.opened import parsing
from realitygap.models.log.schema import ENCODERS, ODOMETRY, POSE

Link = tuple[str, str]
"""Parent and child frame."""


def chain(links: Mapping[Link, object], frame: str, within: str, field: str) -> list[Link]:
    """The links from an outer frame to an inner one, outermost first.

    Raises:
        InputError: they do not lead there.
    """
    parents = {child: parent for parent, child in links}
    path: list[Link] = []
    at = frame
    while at != within and at in parents and len(path) <= len(links):
        path.insert(0, (parents[at], at))
        at = parents[at]
    if at != within or not path:
        listed = ", ".join(f"{parent} > {child}" for parent, child in sorted(links))
        raise InputError(field, f"no way from {within} to {frame}", f"frames among {listed}")
    return path


def composed(parts: list[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Times and poses of the innermost frame of a chain in its outermost.

    Every link holds until it is sent again; a pose stands at each time the innermost link that
    moves was sent.

    Args:
        parts: Per link, outermost first, its times (n,) in s, increasing, and its poses (n, 7): x,
            y, z and a quaternion.

    Returns:
        (n,) s and (n, 7) poses.
    """
    from scipy.spatial.transform import Rotation  # a tenth of a second, and few logs have frames

    moving = [times for times, _ in parts if len(times) > 1]
    when = moving[-1] if moving else parts[-1][0]
    begun = max((times[0] for times in moving), default=-np.inf)
    when = when[when >= begun]
    place, turn = np.zeros((len(when), 3)), Rotation.identity(len(when))
    for times, poses in parts:
        at = np.maximum(np.searchsorted(times, when, side="right") - 1, 0)
        own = poses[at]
        place = place + turn.apply(own[:, :3])
        turn = turn * Rotation.from_quat(own[:, 3:])
    return when, np.column_stack([place, turn.as_quat()])


GUESSED = Path("guessed map")


def read_bag(path: Path, asked: Asked) -> Read:
    """A bag of ROS 1 or ROS 2, or an MCAP file.

    Raises:
        InputError: it cannot be read, its map cannot be used, or none can be guessed.
    """
    with open_bag(path) as bag:
        if asked.map is not None:
            chosen, name, text = read_bag_map(asked.map), asked.map.name, ""
        else:
            text = asked.guessed or guess_topics(bag)
            with parsing(str(path), "topics that a map can name (--map)"):
                chosen = checked(BagMap, tomllib.loads(text), GUESSED, "a map of topics")
            name = str(GUESSED)
        chosen.check(bag, name)
        robots = {0: chosen.topics} if chosen.topics else dict(chosen.robots)
        heard = hear(bag, {topic for one in robots.values() for topic in one.named.values()})
    parts = []
    for robot, topics in robots.items():
        streams = _streams(topics, heard, chosen.clock, f"{path.name}: {robot}")
        parts.append(merged(streams, f"{path.name}: robot {robot}").assign(robot=robot))
    return Read(pd.concat(parts, ignore_index=True), text)


def bag_topics(path: Path) -> pd.DataFrame:
    """What topics a bag has: `topic`, `type`, `messages`, and what they `could_be` in a map.

    Raises:
        InputError: it cannot be read.
    """
    with open_bag(path) as bag:
        return pd.DataFrame(
            [dict(row) for row in describe(bag.topics)],
            columns=["topic", "type", "messages", "could_be"],
        )


def _streams(topics: RobotTopics, heard: Heard, clock: str, field: str) -> list[pd.DataFrame]:
    """What one robot's topics said, by one clock."""
    told = _heard(heard, (topics.commands,), field)
    streams = [_table(told, clock, ("cmd_v", "cmd_omega"), topics.commands)]
    streams.append(_poses(topics.poses, heard, clock, field))
    if topics.odometry is not None:
        said = _heard(heard, (topics.odometry,), field)
        streams.append(_planar(said, clock, ODOMETRY, topics.odometry))
    if topics.gyro is not None:
        said = _heard(heard, (topics.gyro,), field)
        streams.append(_table(said, clock, ("gyro_z",), topics.gyro))
    if topics.wheels is not None:
        for name, joint in zip(ENCODERS, (topics.wheels.left, topics.wheels.right), strict=True):
            said = _heard(heard, (topics.wheels.topic, joint), field)
            both = _table(said, clock, (name, ANGLES[name]), topics.wheels.topic)
            turns = both[ANGLES[name]].notna().any()  # an angle says more than a speed in between
            streams.append(both.drop(columns=name if turns else ANGLES[name]))
    return streams


def _poses(asked: str | Frames, heard: Heard, clock: str, field: str) -> pd.DataFrame:
    if isinstance(asked, Frames):
        links = {(key[1], key[2]): key for key in heard.keys if len(key) == 3}
        path = chain(links, asked.frame, asked.within, f"{field}: poses")
        parts = []
        for link in path:
            said = _heard(heard, links[link], field)
            parts.append(latest(*_sorted(_times(said, clock, asked.topic), said.values)))
        with parsing(f"{field}: poses", f"rotations in {asked.topic}"):
            t, poses = composed([(times, values) for times, values in parts])
        return _placed(t, poses, POSE, asked.topic)
    own = [key for key in heard.keys if key[0] == asked]
    if len(own) > 1:
        children = ", ".join(key[2] for key in own if len(key) == 3)
        expected = "poses = { topic = ..., frame = ..., in = ... }"
        raise InputError(f"{field}: poses", f"several frames in {asked}: {children}", expected)
    key = own[0] if own else (asked,)
    return _planar(_heard(heard, key, field), clock, POSE, asked)


def _heard(heard: Heard, key: tuple[str, ...], field: str) -> Said:
    said = heard.said(key)
    if said is None:
        there = [one[1] for one in heard.keys if len(one) == 2 and one[0] == key[0]]
        expected = f"joints among {', '.join(there)}" if there else "messages of that topic"
        raise InputError(field, f"no {' '.join(key[1:]) or 'message'} in {key[0]}", expected)
    return said


def _times(said: Said, clock: str, topic: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    if clock == "received":
        return said.received
    if np.isnan(said.stamped).any():
        expected = "received: its messages have no stamps"
        raise InputError("clock", f"stamped, for {topic}", expected)
    return said.stamped


def _sorted(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(t, kind="stable")
    return t[order], values[order]


def _table(said: Said, clock: str, names: tuple[str, ...], topic: str) -> pd.DataFrame:
    columns = dict(zip(names, said.values.T, strict=True))
    return pd.DataFrame({"t": _times(said, clock, topic), **columns})


def _planar(said: Said, clock: str, names: tuple[str, ...], topic: str) -> pd.DataFrame:
    return _placed(_times(said, clock, topic), said.values, names, topic)


def _placed(t: np.ndarray, poses: np.ndarray, names: tuple[str, ...], topic: str) -> pd.DataFrame:
    """x, y and yaw of poses, seen from above."""
    yaw = heading(poses[:, 3:], f"quaternion in {topic}")
    return pd.DataFrame({"t": t, **dict(zip(names, (poses[:, 0], poses[:, 1], yaw), strict=True))})

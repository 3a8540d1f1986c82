"""What a manoeuvre will show under each rival: the moments at which they differ most."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import PointModel, readings
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import as_seen
from realitygap.models.gap.driven import driven, recorded, wheel_turns
from realitygap.models.log.frames import Windows, motion
from realitygap.models.log.schema import ENCODERS, LS, PS
from realitygap.models.naming.channels.motion.predict import TICK
from realitygap.models.naming.proposal.ground import DARK, Ground, resampled
from realitygap.models.naming.proposal.menu import Expected, Flight

AHEAD = 1.0
"""s over which motion is told. No rule: as long as a person sees at a glance."""
LEAST = 1.0
"""Standard deviations of noise below which a channel is not told. No rule: nobody would see it."""
ROOT = 3.0**0.5
"""Half width of uniform noise over its standard deviation. No rule: of statistics."""


class Flown(NamedTuple):
    """A manoeuvre as it is commanded, at the log's rate."""

    t: FloatArray
    """(rows,) s."""
    poses: FloatArray
    """(rows, robots, 3) planned, in the log's frame."""
    commands: FloatArray
    """(rows, robots, 2) rad/s."""
    lamp: int
    """Index into the model's lamps."""


def flown(flight: Flight, ground: Ground) -> Flown:
    """A flight as it is to be commanded, robots in formation as far apart as there is room.

    Nobody leads them home between laps, so that one with a fault strays.
    """
    step, poses = ground.step, flight.poses
    if flight.probe.formation:
        poses = ground.spread(poses)
    poses, commands = resampled(poses, flight.commands, every=step, step=step)
    lamp = DARK if flight.probe.dark else ground.lamp
    return Flown(
        step * np.arange(len(commands), dtype=np.float64), poses + ground.middle, commands, lamp
    )


def moves(
    told: Flown,
    robots: Sequence[int],
    rivals: Sequence[Sequence[Motion]],
    noise: tuple[float, float],
) -> tuple[Expected, ...]:
    """The channels of motion that tell rivals apart, best first: each in the robot that shows it.

    Args:
        told: The manoeuvre.
        robots: Indices of the robots concerned.
        rivals: Under each rival the motion of each of these robots, the named cause first.
        noise: m and rad, of the tracker.
    """
    return _foremost(
        one
        for k, robot in enumerate(robots)
        for one in _moves(told, robot, [motions[k] for motions in rivals], noise)
    )


def reads(told: Flown, rivals: Sequence[Sequence[PointModel]]) -> tuple[Expected, ...]:
    """The same of infrared, light and the nest; of each rival the point model of every robot."""
    return _foremost(
        one
        for robot in range(told.poses.shape[1])
        for one in _reads(told, robot, [points[robot] for points in rivals])
    )


def _foremost(found: Iterable[Expected]) -> tuple[Expected, ...]:
    """Of each channel what is farthest apart."""
    best: dict[str, Expected] = {}
    for one in found:
        if one.apart > best.get(one.channel, one._replace(apart=LEAST)).apart:
            best[one.channel] = one
    return tuple(sorted(best.values(), key=lambda one: -one.apart))


def _moves(
    told: Flown, robot: int, motions: Sequence[Motion], noise: tuple[float, float]
) -> Iterator[Expected]:
    """Of motion over a second, and of the encoders' speeds."""
    t, commands = told.t, np.ascontiguousarray(told.commands[:, robot])
    cut = np.array([0, len(t)])
    rows = max(1, round(AHEAD / (t[1] - t[0])))
    first = np.arange(len(t) - rows)
    moved, turned = [], []
    for one in motions:
        late = one.motor_delay + one.pose_delay
        path = recorded(t, driven(t, commands, cut, one.drive, late), cut, one)
        moved.append(motion(as_seen(path, one), Windows(first, first + rows)))
        turns = wheel_turns(t, commands, cut, one.wheels, one.motor_delay)
        turned.append(np.diff(turns, axis=0) / np.diff(t)[:, None])
    position, heading = (max(one, 1e-9) * 2.0**0.5 for one in noise)
    names = (("along", "m", position), ("across", "m", position), ("heading", "rad", heading))
    for k, (name, unit, level) in enumerate(names):
        yield _best(robot, t, rows, name, unit, np.stack([m[:, k] for m in moved]), level)
    level = TICK / float(t[1] - t[0]) / np.sqrt(6.0)
    for k, name in enumerate(ENCODERS):
        yield _best(robot, t, 1, name, "rad/s", np.stack([w[:, k] for w in turned]), level)


def _reads(told: Flown, robot: int, points: Sequence[PointModel]) -> Iterator[Expected]:
    """Of infrared, light and the nest at the planned poses."""
    t, poses = told.t, np.ascontiguousarray(told.poses[:, robot])
    inside = [np.hypot(*(poses[:, :2] - p.nest[:2]).T) < p.nest[2] for p in points]
    yield _best(robot, t, 0, "nest", "1", np.stack(inside).astype(float), 1.0 / ROOT)
    tables = points[0].tables
    if tables is None:
        return
    lamp = np.full(len(t), told.lamp, dtype=np.int32)
    read = [readings(poses, lamp, t, model=point) for point in points]
    for k, name in enumerate(PS):
        values = np.stack([one.ps[:, k] for one in read])
        level = (tables.ps_noise[k] * values.mean(axis=0) + tables.ps_noise_floor) / ROOT
        yield _best(robot, t, 0, name, "counts", values, level)
    for k, name in enumerate(LS):
        values = np.stack([one.ls[:, k] for one in read])
        yield _best(robot, t, 0, name, "counts", values, tables.ls_noise / ROOT)


def _best(
    robot: int,
    t: FloatArray,
    rows: int,
    channel: str,
    unit: str,
    values: FloatArray,
    level: FloatArray | float,
) -> Expected:
    """The moment at which the first of `values` (rivals, n) is farthest from its nearest rival."""
    far = np.abs(values[1:] - values[0]).min(axis=0) / level
    at = int(far.argmax())
    told = tuple(values[:, at].tolist())
    return Expected(robot, float(t[at]), float(t[at + rows]), channel, unit, told, float(far[at]))

"""What follows which measured quantity: flexible terms that no physics stands behind.

Whatever is wrong with a robot, if it follows something measured (heading, place, time, speed, a
wheel's angle, neighbours), then speed, bend or turn rate change in step with that quantity. Each
such change is carried through the predicted path as a cause would be and fitted to the errors that
the named causes leave; its size is judged against what healthy robots show for the same quantity.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.predict import wheel_angles
from realitygap.models.naming.channels.motion.tracks import TURNED, Tracks

CHANNELS = {
    "speed": "it drives faster or slower",
    "bend": "its path bends",
    "turn_rate": "it turns faster or slower",
    "aside": "it slides sideways",
    "wheels": "each of its wheels turns faster or slower",
}
"""What may follow a quantity, in words."""

QUANTITIES = {
    "heading": "which way it faces",
    "heading_twice": "which axis it faces along",
    "place": "where in the arena it is",
    "radial": "whether it faces away from or towards the arena's middle",
    "radius": "how far from the arena's middle it is",
    "time": "how long the log has lasted",
    "speed": "how fast it is told to drive",
    "speed_squared": "the square of the commanded speed",
    "wheel_speed": "how fast that wheel is told to turn",
    "turning": "how fast it is told to turn",
    "turn_side": "to which side it is told to turn",
    "left_wheel_angle": "the angle of its left wheel",
    "right_wheel_angle": "the angle of its right wheel",
    "wall": "how near the wall is",
    "neighbour": "how near the next robot is",
    "change": "how much the command has just changed",
    "start": "whether it has just been told to leave rest",
    "food": "whether it carries or is on food",
    "nest": "whether it is in the nest",
}
"""What it may follow, in words."""

BODY = ("speed", "bend", "turn_rate", "aside")
"""Channels that may follow any quantity."""
WHEELS = "wheels"
"""The channel in which both wheels follow a quantity, or each its own command's speed:"""
OWN_SPEED = "wheel_speed"
"""that quantity."""


class Steps:
    """The predicted path from row to row within windows."""

    def __init__(self, tracks: Tracks, predicted: FloatArray) -> None:
        self._first, self._window = tracks.first, tracks.window
        self._robots = np.flatnonzero(np.diff(tracks.robot[self._window])) + 1
        move = np.diff(predicted, axis=0, prepend=predicted[:1])
        move[tracks.first] = 0.0
        middle = predicted[:, 2] - 0.5 * move[:, 2]
        self.ahead = np.cos(middle) * move[:, 0] + np.sin(middle) * move[:, 1]
        self.turn = move[:, 2]
        self._cos, self._sin = np.cos(middle), np.sin(middle)

    def change(self, channel: str, q: FloatArray) -> FloatArray:
        """(n, 3) change of the predicted poses per unit of a term whose strength follows q."""
        ahead, aside, turn = np.zeros_like(q), np.zeros_like(q), np.zeros_like(q)
        if channel == "speed":
            ahead = q * self.ahead
        elif channel == "aside":
            aside = q * self.ahead
        elif channel == "bend":
            turn = q * np.abs(self.ahead) / 0.1  # rad per 100 mm driven
        else:
            turn = q * self.turn
        return self.carried(ahead, aside, turn)

    def of_wheels(self, q: FloatArray, axle: FloatArray) -> FloatArray:
        """(n, 3) change of the predicted poses per unit of each wheel's following its own q.

        Args:
            q: (n, 2).
            axle: (n,) m.
        """
        half = 0.5 * axle * self.turn
        left, right = q[:, 0] * (self.ahead - half), q[:, 1] * (self.ahead + half)
        return self.carried(0.5 * (left + right), np.zeros(len(half)), (right - left) / axle)

    def carried(self, ahead: FloatArray, aside: FloatArray, turn: FloatArray) -> FloatArray:
        """(n, ..., 3) change of the poses from (n, ...) changes of each row's step."""
        wide = (-1,) + (1,) * (turn.ndim - 1)
        cos, sin, own = (one.reshape(wide) for one in (self._cos, self._sin, self.ahead))
        swing = self._sum(turn)
        across = aside + own * swing
        x = self._sum(cos * ahead - sin * across)
        y = self._sum(sin * ahead + cos * across)
        return np.stack([x, y, swing], axis=-1)

    def _sum(self, values: FloatArray) -> FloatArray:
        """Sums from each window's first row."""
        each = np.split(values, self._robots)  # a robot's sums do not depend on the others
        total = np.concatenate([np.cumsum(one, axis=0) for one in each])
        return np.asarray(total - (total - values)[self._first][self._window])


def quantities(tracks: Tracks, motions: Sequence[Motion]) -> dict[tuple[str, str], FloatArray]:
    """(rows,) values of every function of every quantity that the log has."""
    rules = tracks.rules
    about = {name: tracks.about[:, k] for k, name in enumerate(tracks.columns)}
    heading, x, y = about["heading"], about["x"], about["y"]
    bearing = np.arctan2(y, x)
    if set(TURNED) <= set(about):
        left, right = (about[name] for name in TURNED)
    else:
        left, right = wheel_angles(tracks, motions).T
    speed, turn = about["speed"], about["turn"]
    changed = np.append(-1, np.flatnonzero(about["change"] > 0.0))
    last = changed[np.searchsorted(changed, np.arange(len(tracks.t)), side="right") - 1]
    began = np.searchsorted(tracks.row_robot, tracks.row_robot)
    since = np.where(last >= began, tracks.t - tracks.t[last], np.inf)
    values = {
        ("heading", " sin"): np.sin(heading),
        ("heading", " cos"): np.cos(heading),
        ("heading_twice", " sin"): np.sin(2.0 * heading),
        ("heading_twice", " cos"): np.cos(2.0 * heading),
        ("place", " x"): x,
        ("place", " y"): y,
        ("radial", ""): np.cos(heading - bearing),
        ("radius", ""): about["radius"],
        ("time", ""): about["time"],
        ("speed", ""): np.abs(speed),
        ("speed_squared", ""): speed**2,
        ("turning", ""): np.abs(turn),
        ("turn_side", ""): np.sign(turn),
        ("left_wheel_angle", " sin"): np.sin(left),
        ("left_wheel_angle", " cos"): np.cos(left),
        ("right_wheel_angle", " sin"): np.sin(right),
        ("right_wheel_angle", " cos"): np.cos(right),
        ("neighbour", ""): np.exp(-about["near_robot"].clip(0.0) / rules.near),
        ("change", ""): np.exp(-np.maximum(since, 0.0) / rules.recent),
        ("start", ""): np.exp(-tracks.since_start / rules.started),
    }
    if "near_wall" in about:
        values["wall", ""] = np.exp(-about["near_wall"].clip(0.0) / rules.near)
    for name in ("food", "nest"):
        if name in about:
            values[name, ""] = about[name]
    return {key: np.nan_to_num(v) for key, v in values.items()}


def wheel_speeds(problem: Problem) -> FloatArray:
    """(n, 2) how fast each wheel is told to turn; per robot mean 0 and standard deviation 1."""
    tracks = problem.tracks
    speed = np.abs(tracks.commands[tracks.rows])
    robot = tracks.robot[tracks.window]
    both, twice = speed.T.ravel(), np.tile(robot, 2)
    count = np.maximum(np.bincount(twice, minlength=problem.count), 1)
    mean = np.bincount(twice, both, problem.count) / count
    square = np.bincount(twice, (both - mean[twice]) ** 2, problem.count) / count
    return np.asarray((speed - mean[robot, None]) / np.sqrt(np.maximum(square, 1e-9))[robot, None])


def axles(tracks: Tracks, motions: Sequence[Motion]) -> FloatArray:
    """(n,) m."""
    axle = np.array([motion.drive.axle for motion in motions])
    return np.asarray(axle[tracks.robot[tracks.window]])


def standardised(problem: Problem, q: FloatArray) -> FloatArray | None:
    """Per robot mean 0 and standard deviation 1; None where the quantity never varies."""
    robot = problem.tracks.robot[problem.tracks.window]
    count = np.maximum(np.bincount(robot, minlength=problem.count), 1)
    mean = np.bincount(robot, q, problem.count) / count
    centred = q - mean[robot]
    sd = np.sqrt(np.bincount(robot, centred**2, problem.count) / count)
    if sd.max() < 1e-9:
        return None
    return np.asarray(centred / np.maximum(sd, 1e-9)[robot] * (sd > 1e-9)[robot])

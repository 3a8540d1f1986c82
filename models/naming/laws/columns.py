"""What a law would change in a robot's pose windows, per unit of its amplitude, by replay.

The predicted path comes from C. A law changes each of its steps, and the change is carried through
the rest of the window. Nothing is differentiated that was measured.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.embedded_sim.laws import STANDS, Atom, Channel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.law_values import Known, product
from realitygap.models.naming.channels.motion.flexible import Steps
from realitygap.models.naming.channels.motion.predict import poses, wheel_angles
from realitygap.models.naming.channels.motion.robot import Robot
from realitygap.models.naming.channels.motion.tracks import TURNED

WHEELS = ("left", "right")
NEVER = 1e3
"""s since a start, or m to a robot, where there is none. No rule: far."""


class LawColumns:
    """One robot's windows at its motion: quantities at the middle of every step, and columns."""

    def __init__(self, robot: Robot, plain: LawColumns | None = None) -> None:
        """Prepare.

        Args:
            robot: At its motion.
            plain: The robot without the laws of its motion, whose steps they are shares of; None:
                it has none.
        """
        tracks, motion = robot.tracks, robot.motion
        self.robot = robot
        predicted = poses(tracks, [motion])
        self._steps = Steps(tracks, predicted)
        self._cos, self._sin = np.cos(predicted[:, 2]), np.sin(predicted[:, 2])
        self._axle = motion.drive.axle
        self._noise = tracks.noise
        took = np.diff(tracks.t[tracks.rows], prepend=0.0)
        took[tracks.first] = 0.0
        self._plain = self._steps if plain is None else plain._steps
        self.known = _known(robot, self._plain, took)
        fastest = np.maximum(*(np.abs(self.known[side]) for side in WHEELS))
        self._moving = took * (fastest > STANDS)

    @property
    def segment(self) -> FloatArray:
        """(n,) of each row."""
        return np.asarray(self.robot.tracks.row_segment[self.robot.tracks.rows])

    def strength(self, channel: Channel, atoms: Sequence[Atom]) -> FloatArray:
        """(n, sides) of a law in each wheel that it changes, or in the body."""
        sides = {"left": (0,), "right": (1,), "both": (0, 1)}.get(channel, (-1,))
        return np.column_stack([product(atoms, self.of_side(side)) for side in sides])

    def of_side(self, side: int) -> Known:
        """Quantities as one wheel has them; -1: the body."""
        if side < 0:
            return self.known
        return {**self.known, "wheel_speed": self.known[WHEELS[side]]}

    def white(self, channel: Channel, strength: FloatArray) -> FloatArray:
        """(rows, q) white columns of (n, sides, q) or (n, q) strengths."""
        wide = strength if strength.ndim == 3 else strength[:, None, :]
        return self.robot.white(self.change(channel, wide))

    def change(self, channel: Channel, q: FloatArray) -> FloatArray:
        """(n, 3, q) what (n, sides, q) strengths change of the errors, in noise."""
        ahead, turn = self._plain.ahead[:, None], self._plain.turn[:, None]
        none = np.zeros((len(q), q.shape[2]))
        match channel:
            case "left" | "right" | "both":
                half = 0.5 * self._axle * turn
                left = none if channel == "right" else q[:, 0] * (ahead - half)
                right = none if channel == "left" else q[:, -1] * (ahead + half)
                moved = 0.5 * (left + right), none, (right - left) / self._axle
            case "speed":
                moved = q[:, 0] * ahead, none, none
            case "aside":
                moved = none, q[:, 0] * ahead, none
            case "turning":
                moved = none, none, q[:, 0] * turn
            case "turn":
                moved = none, none, q[:, 0] * self._moving[:, None]
            case "bend":
                moved = none, none, q[:, 0] * np.abs(ahead)
        return self._seen(self._steps.carried(*moved))

    def _seen(self, change: FloatArray) -> FloatArray:
        """(n, 3, q) of (n, q, 3) changes of the predicted poses: ahead, to the left, heading."""
        c, s = self._cos[:, None], self._sin[:, None]
        x, y, yaw = change[..., 0], change[..., 1], change[..., 2]
        return np.stack(
            [
                (c * x + s * y) / self._noise.position,
                (c * y - s * x) / self._noise.position,
                yaw / self._noise.heading,
            ],
            axis=1,
        )


def _known(robot: Robot, steps: Steps, took: FloatArray) -> dict[str, FloatArray]:
    """Quantities at the middle of every step that the log holds, by name."""
    tracks = robot.tracks
    rows = tracks.rows
    about = {name: tracks.about[rows, k] for k, name in enumerate(tracks.columns)}
    heading = about["heading"] - 0.5 * steps.turn
    back = 0.5 * steps.ahead
    place = np.column_stack(
        [about["x"] - back * np.cos(heading), about["y"] - back * np.sin(heading)]
    )
    if set(TURNED) <= set(about):
        angles = np.column_stack([about[name] for name in TURNED])
    else:
        angles = wheel_angles(tracks, [robot.motion])[rows]
    long = np.maximum(took, 1e-9)
    speed, turn = steps.ahead / long, steps.turn / long
    half = 0.5 * robot.motion.drive.axle * turn
    left, right = robot.motion.drive.wheel_radius
    known = {
        "left": (speed - half) / left,
        "right": (speed + half) / right,
        "speed": speed,
        "turn": turn,
        "heading": heading,
        "left_angle": angles[:, 0],
        "right_angle": angles[:, 1],
        "time": about["time"],
        "since": np.minimum(tracks.since_start[rows], NEVER),
    }
    known["left_angle"] = angles[:, 0] - 0.5 * took * known["left"]
    known["right_angle"] = angles[:, 1] - 0.5 * took * known["right"]
    known["place"] = place
    if "near_wall" in about:
        known |= {"radius": np.hypot(*place.T), "wall": about["near_wall"]}
    if np.isfinite(about["near_robot"]).any():
        known["gap"] = np.minimum(about["near_robot"], NEVER)
    return known

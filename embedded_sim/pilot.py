"""Who drives robots through a manoeuvre: home by what the tracker sees, then by schedule."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import CONTROL_STEP, FloatArray, PointModel
from realitygap.embedded_sim.probes import MIDDLE, Lap, Probe

ARRIVED = 0.010
"""m from home at which a robot is there."""
LEFT_AGAIN = 0.020
"""m from home at which it no longer is."""
TURNED = 0.06
"""rad from home's heading at which a robot is aligned."""
AHEAD = 0.5
"""rad of bearing within which a robot drives towards home; else it turns on the spot."""
GAIN = 3.0
"""1/s of error in heading and of distance; our choice: steady with 0.2 s of dead time."""
PATIENCE = 12.0
"""s after which the lap begins wherever the robots are: a faulty robot may never get home."""


class Pilot:
    """One swarm's manoeuvre; call `step` once every control step."""

    def __init__(self, probe: Probe, robots: int, model: PointModel) -> None:
        """Plan the first lap.

        Args:
            probe: What to do.
            robots: How many.
            model: What is believed of robot and arena.

        Raises:
            InputError: so many robots do not find room.
        """
        self._probe, self._robots, self._model = probe, robots, model
        self._number = 0
        self._lap: Lap = probe.lap(0, robots, model)
        self._there = np.zeros(robots, dtype=np.bool_)
        self._homing, self._at = 0, 0
        self._underway = False
        self.commands: FloatArray = np.zeros((robots, 2))
        """rad/s, left and right."""

    @property
    def starts(self) -> FloatArray:
        """(robots, 3) m, m, rad where the robots are put down."""
        return self._lap.homes

    def step(self, poses: FloatArray) -> FloatArray:
        """The commands from now on, where the tracker sees the robots at `poses` (robots, 3)."""
        if not self._underway:
            commands, home = self._home(poses)
            self._homing += 1
            if not home.all() and self._homing * CONTROL_STEP < PATIENCE:
                self.commands = commands
                return commands
            self._underway, self._at = True, 0
        self.commands = self._lap.wheels[self._at].copy()
        self._at += 1
        if self._at == len(self._lap.wheels):
            self._number += 1
            self._lap = self._probe.lap(self._number, self._robots, self._model)
            self._underway, self._homing = False, 0
            self._there[:] = False
        return self.commands

    def _home(self, poses: FloatArray) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
        """Commands (robots, 2) that lead home, and who is there."""
        homes, drive = self._lap.homes, self._model.drive
        away = homes[:, :2] - poses[:, :2]
        distance = np.hypot(away[:, 0], away[:, 1])
        self._there = distance < np.where(self._there, LEFT_AGAIN, ARRIVED)
        bearing = _wrapped(np.arctan2(away[:, 1], away[:, 0]) - poses[:, 2])
        # a little way back is gone backwards
        backwards = (np.abs(bearing) > 0.5 * np.pi) & (distance < 0.1)
        bearing = np.where(backwards, _wrapped(bearing + np.pi), bearing)
        askew = np.where(self._there, _wrapped(homes[:, 2] - poses[:, 2]), bearing)
        go = ~self._there & (np.abs(askew) < AHEAD)
        speed = np.where(go, GAIN * distance, 0.0) * np.where(backwards, -1.0, 1.0)
        turn = 0.5 * drive.axle * GAIN * askew
        left, right = drive.wheel_radius
        wheels = np.column_stack([(speed - turn) / left, (speed + turn) / right])
        most = np.abs(wheels).max(axis=1, keepdims=True)
        wheels *= np.minimum(1.0, MIDDLE / np.maximum(most, 1e-9))
        home = self._there & (np.abs(askew) < TURNED)
        wheels[home] = 0.0
        known = np.isfinite(poses).all(axis=1)
        wheels[~known] = 0.0
        return wheels, home & known


def fly(probe: Probe, robots: int, model: PointModel, steps: int) -> tuple[FloatArray, FloatArray]:
    """The manoeuvre as the point model has it.

    Returns:
        Poses (steps, robots, 3), m, m, rad, and the commands (steps, robots, 2), rad/s, from each
        of them on.

    Raises:
        InputError: so many robots do not find room.
    """
    pilot = Pilot(probe, robots, model)
    pose = pilot.starts.copy()
    poses, commands = np.empty((steps, robots, 3)), np.empty((steps, robots, 2))
    radius, axle = np.array(model.drive.wheel_radius), model.drive.axle
    for k in range(steps):
        poses[k] = pose
        commands[k] = pilot.step(pose)
        way = commands[k] * radius * CONTROL_STEP
        ahead, turn = way.mean(axis=1), (way[:, 1] - way[:, 0]) / axle
        chord = ahead * np.sinc(0.5 * turn / np.pi)
        heading = pose[:, 2] + 0.5 * turn
        pose = pose + np.column_stack([chord * np.cos(heading), chord * np.sin(heading), turn])
    return poses, commands


def _wrapped(angle: FloatArray) -> FloatArray:
    """Angles (rad) as the same directions in [-pi, pi)."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)

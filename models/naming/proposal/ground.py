"""Where a manoeuvre can be driven, and how fast: what the model and the log show to be possible."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from realitygap.embedded_sim import CONTROL_STEP, SCENARIOS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.probes import FAST
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.gap.sensing import scenarios
from realitygap.models.log.measured import MeasuredLog

DARK = SCENARIOS.index("none")
DESIGNED_BODY = 0.035
"""m, radius of the e-puck, which the menu's lengths were made for. No rule: of the menu."""
CLEARANCE = 0.7
"""Body radii left to the wall. No rule: 25 mm of an e-puck, as everywhere in the menu."""
WIDER = 2.0
"""Most times by which a formation is spread. No rule: then nobody reaches a neighbour."""
ROUNDING = 1e-9
"""s, and of a row. No rule: of numerics."""


@dataclass(frozen=True, kw_only=True)
class Ground:
    """A circle of floor for robots of some size and speed, and how they are logged."""

    x: float
    y: float
    radius: float
    """m."""
    walled: bool
    """Whether there is a wall around it, with lamp and nest where the model has them."""
    body_radius: float
    """m."""
    fastest: float
    """rad/s that a wheel turns at most."""
    step: float = CONTROL_STEP
    """s between two rows of the log."""
    lamp: int = DARK
    """Where the log's lamp mostly stood, index into the model's lamps."""

    @property
    def middle(self) -> FloatArray:
        """(3,) m, m, rad: the pose that is the menu's origin."""
        return np.array([self.x, self.y, 0.0])

    @property
    def size(self) -> float:
        """Lengths of the robot over those that the menu was made for."""
        return self.body_radius / DESIGNED_BODY

    @property
    def pace(self) -> float:
        """Speeds over the menu's; at most 1."""
        return min(1.0, self.fastest / FAST)

    def believed(self, model: PointModel) -> PointModel:
        """The model of a robot as small as those that the menu was made for, on this ground."""
        drive, size = model.drive, self.size
        left, right = drive.wheel_radius
        smaller = replace(drive, wheel_radius=(left / size, right / size), axle=drive.axle / size)
        return replace(
            model,
            drive=smaller,
            body_radius=self.body_radius / size,
            arena_radius=self.radius / size,
        )

    def spread(self, poses: FloatArray) -> FloatArray:
        """Poses (steps, robots, 3) with the robots' homes farther apart, where there is room."""
        homes = poses[:1] * [1.0, 1.0, 0.0]
        out = float(np.hypot(homes[..., 0], homes[..., 1]).max())
        away = poses - homes
        reach = float(np.hypot(away[..., 0], away[..., 1]).max())
        room = self.radius - self.body_radius * (1.0 + CLEARANCE) - reach
        return poses + max(0.0, min(WIDER, room / out if out else 1.0) - 1.0) * homes

    def full(self, poses: FloatArray, commands: FloatArray) -> tuple[FloatArray, FloatArray]:
        """A flight of such a robot as this one drives it: as large as it is, and no faster.

        Args:
            poses: (steps, robots, 3) m, m, rad, about the middle.
            commands: (steps, robots, 2) rad/s.
        """
        grown = poses * [self.size, self.size, 1.0]
        return resampled(grown, commands, every=CONTROL_STEP * self.pace, step=CONTROL_STEP)


def resampled(
    poses: FloatArray, commands: FloatArray, *, every: float, step: float
) -> tuple[FloatArray, FloatArray]:
    """A flight of one row per control step in other rows: wheels turn by the same angles.

    Args:
        poses: (steps, robots, 3).
        commands: (steps, robots, 2) rad/s, from each step on.
        every: s of the flight from one row to the next.
        step: s that a row then takes.
    """
    if abs(every - CONTROL_STEP) < ROUNDING and abs(step - CONTROL_STEP) < ROUNDING:
        return poses, commands
    steps, robots = commands.shape[:2]
    t = CONTROL_STEP * np.arange(steps + 1)
    at = every * np.arange(int(t[-1] / every + ROUNDING) + 1)
    turned = np.concatenate([np.zeros((1, robots, 2)), np.cumsum(commands, axis=0) * CONTROL_STEP])
    rows = len(at) - 1
    where, found = np.empty((rows, robots, 3)), np.empty((rows, robots, 2))
    for robot in range(robots):
        for k in range(3):
            where[:, robot, k] = np.interp(at[:-1], t[:-1], poses[:, robot, k])
        for k in range(2):
            found[:, robot, k] = np.diff(np.interp(at, t, turned[:, robot, k])) / step
    return where, found


def ground(model: ModelFile, log: MeasuredLog) -> Ground:
    """The arena where the model has one; else the circle that the log's robots stayed in."""
    robot, arena = model.robot, model.arena
    x, y, radius = 0.0, 0.0, 0.0 if arena is None else arena.radius
    if arena is None:
        places = log.poses[log.tracked, :2]
        x, y = (0.5 * (places.min(axis=0) + places.max(axis=0))).tolist()
        radius = float(np.hypot(*(places - (x, y)).T).max()) + robot.body_radius
    lit = scenarios(log)
    lit = lit[lit >= 0]
    return Ground(
        x=x,
        y=y,
        radius=radius,
        walled=arena is not None,
        body_radius=robot.body_radius,
        fastest=robot.wheel_speed_max,
        step=round(log.step, 9),
        lamp=int(np.bincount(lit).argmax()) if len(lit) else DARK,
    )

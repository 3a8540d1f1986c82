"""What the physics engine does that no robot does, and how much of it.

The last table of `realitygap measure convergence`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from realitygap.reality import constants as k
from realitygap.reality.engine import DEFAULT, Engine, EngineName, engine_class

FloatArray = npt.NDArray[np.float64]

HEADINGS = 12
SPACING = 5.0
"""m between robots that must not meet: none moves as far in these seconds."""
FULL = 6.0
"""rad/s: full speed."""
SLOW = 2.0
"""rad/s from which a robot rolls freely."""
SETTLE = 1.0
"""s after which a robot that was put down or sent off is steady."""
WATCHED = 10.0
"""s over which a slow motion is watched."""
NO_TORQUE = 1e-9
"""N m: a motor that neither drives nor brakes, with some."""
TILT = math.radians(2.0)
GAP = 0.02
"""m between bodies, from which one rolls freely into the other."""
BRIEF = 0.05
"""s over which a speed is taken."""
PARTED = 0.1
"""s after an impact at which the bodies have parted and the wheels roll again."""


@dataclass(frozen=True)
class Setting:
    """Physics step (s), the solver's iterations and the engine that they are of."""

    step: float
    iterations: int
    name: EngineName = DEFAULT

    @property
    def cells(self) -> str:
        """The first cells of a row."""
        return f"| {self.name} | {1e3 * self.step:g} | {self.iterations} |"

    def engine(self, gravity: tuple[float, float, float] = (0.0, 0.0, -k.GRAVITY)) -> Engine:
        """An empty world with a floor."""
        return engine_class(self.name)(step=self.step, iterations=self.iterations, gravity=gravity)


class Watched:
    """Robots on an open floor, seen at every moment."""

    def __init__(self, engine: Engine, poses: FloatArray, step: float) -> None:
        self._engine, self._step, self._robots = engine, step, len(poses)
        for pose in poses.tolist():
            engine.add_epuck(pose)

    def drive(self, robot: int, speed: float, torque: float = k.MOTOR_TORQUE) -> None:
        """Both wheels of a robot at a speed (rad/s), with a torque (N m) at most."""
        self._engine.drive(robot, speed, speed, torque)

    def advance(self, seconds: float) -> None:
        """Let time pass (s)."""
        self._engine.advance(round(seconds / self._step))

    def poses(self) -> FloatArray:
        """(robots, 3) m, m, rad."""
        poses = np.zeros((self._robots, 3))
        self._engine.poses(poses)
        return poses

    def moved(self, seconds: float) -> FloatArray:
        """(robots, 2) m that each moves ahead and to its left meanwhile."""
        before = self.poses()
        self.advance(seconds)
        way = self.poses()[:, :2] - before[:, :2]
        c, s = np.cos(before[:, 2]), np.sin(before[:, 2])
        return np.stack([c * way[:, 0] + s * way[:, 1], c * way[:, 1] - s * way[:, 0]], axis=1)


@contextmanager
def floor(setting: Setting, poses: FloatArray, tilt: float = 0.0) -> Iterator[Watched]:
    """An open floor with robots at poses (robots, 3), level or tilted down along x (rad)."""
    gravity = (k.GRAVITY * math.sin(tilt), 0.0, -k.GRAVITY * math.cos(tilt))
    engine = setting.engine(gravity)
    try:
        yield Watched(engine, poses, setting.step)
    finally:
        engine.close()


def _apart() -> FloatArray:
    """Poses (HEADINGS, 3) of robots that do not meet, each at another heading."""
    index = np.arange(HEADINGS)
    return np.stack([SPACING * index, 0.0 * index, 2.0 * np.pi * index / HEADINGS], axis=1)


def creep(setting: Setting, tilt: float = 0.0) -> FloatArray:
    """(headings, 2) m/s, ahead and to the left, of robots whose motors hold them at rest."""
    with floor(setting, _apart(), tilt) as seen:
        for robot in range(HEADINGS):
            seen.drive(robot, 0.0)
        seen.advance(SETTLE)
        return seen.moved(WATCHED) / WATCHED


def stop(setting: Setting) -> float:
    """m that a robot rolls on after a stop is commanded at full speed."""
    with floor(setting, _apart()) as seen:
        for robot in range(HEADINGS):
            seen.drive(robot, FULL)
        seen.advance(SETTLE)
        for robot in range(HEADINGS):
            seen.drive(robot, 0.0)
        return float(seen.moved(SETTLE)[:, 0].mean())


def analytic_stop() -> float:
    """m: the motors' torque brakes body and rotors, and nothing skids."""
    moving = k.MASS + 2.0 * k.WHEEL_INERTIA / k.WHEEL_RADIUS**2
    braking = 2.0 * k.MOTOR_TORQUE / k.WHEEL_RADIUS / moving
    return float((FULL * k.WHEEL_RADIUS) ** 2 / (2.0 * braking))


def rolling(setting: Setting) -> tuple[float, float]:
    """m/s of a robot when its motors let go, and `WATCHED` s later."""
    with floor(setting, _apart()) as seen:
        for robot in range(HEADINGS):
            seen.drive(robot, SLOW)
        seen.advance(SETTLE)
        before = seen.moved(setting.step)[:, 0].mean() / setting.step
        for robot in range(HEADINGS):
            seen.drive(robot, 0.0, NO_TORQUE)
        seen.advance(WATCHED)
        return float(before), float(seen.moved(setting.step)[:, 0].mean() / setting.step)


def drift(setting: Setting) -> float:
    """m/s, largest over headings, that robots at full speed slide sideways on the tilted floor."""
    with floor(setting, _apart(), TILT) as seen:
        for robot in range(HEADINGS):
            seen.drive(robot, FULL)
        seen.advance(SETTLE)
        return float(np.abs(seen.moved(4.0)[:, 1]).max() / 4.0)


def impact(setting: Setting) -> float:
    """Share by which the momentum of two robots grows when one rolls into the other, at rest.

    Both motors are let go shortly before. The robots are equal and their wheels roll: momentum goes
    as the sum of speeds.
    """
    ends = _apart()
    way = 2.0 * k.BODY_RADIUS + GAP + SETTLE * FULL * k.WHEEL_RADIUS
    hit = ends + way * np.stack([np.cos(ends[:, 2]), np.sin(ends[:, 2]), 0.0 * ends[:, 2]], axis=1)
    with floor(setting, np.concatenate([ends, hit])) as seen:
        for robot in range(HEADINGS):
            seen.drive(robot, FULL)
            seen.drive(HEADINGS + robot, 0.0)
        seen.advance(SETTLE)
        for robot in range(2 * HEADINGS):
            seen.drive(robot, 0.0, NO_TORQUE)
        before = seen.moved(BRIEF)[:, 0].sum()
        seen.advance(GAP / (FULL * k.WHEEL_RADIUS) + PARTED - BRIEF)
        return float(seen.moved(BRIEF)[:, 0].sum() / before - 1.0)


def figures(setting: Setting) -> dict[str, float]:
    """Every artefact under a setting: mm, mm/s, per cent."""
    level, tilted = creep(setting), creep(setting, TILT)
    then, later = rolling(setting)
    return {
        "creep at rest: mean (mm/s)": 1e3 * float(level[:, 0].mean()),
        "largest (mm/s)": 1e3 * float(level[:, 0].max()),
        "stop (mm)": 1e3 * stop(setting),
        "free roll: at first (mm/s)": 1e3 * then,
        "10 s later (mm/s)": 1e3 * later,
        "momentum gained (%)": 100.0 * impact(setting),
        "tilt: creep at rest (mm/s)": 1e3 * float(np.hypot(*tilted.T).max()),
        "drift at full speed (mm/s)": 1e3 * drift(setting),
    }


def artefacts(settings: Sequence[Setting]) -> str:
    """The table of the artefacts under several settings, as Markdown."""
    rows = [(setting, figures(setting)) for setting in settings]
    lines = [
        f"By hand a robot stops within {1e3 * analytic_stop():.2f} mm; nothing else should be.\n",
        f"| engine | step (ms) | iterations | {' | '.join(rows[0][1])} |",
        "|---" * (3 + len(rows[0][1])) + "|",
    ]
    for setting, found in rows:
        cells = " | ".join(f"{value:.3g}" for value in found.values())
        lines.append(f"{setting.cells} {cells} |")
    return "\n".join(lines)

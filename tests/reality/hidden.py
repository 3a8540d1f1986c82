"""Two robots side by side, the second of which may have an effect; what they do is measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from realitygap.reality import constants as k
from realitygap.reality.effects import parse_effects
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.world import World

FloatArray = npt.NDArray[np.float64]
Commands = Callable[[int], tuple[float, float]]

ENGINE: EngineName = DEFAULT
"""Of the worlds; the fixture `engine` puts each in turn."""
FULL = 6.0
"""rad/s."""
SPEED = FULL * k.WHEEL_RADIUS
"""m/s."""
STEP = k.CONTROL_STEP
SIDE_BY_SIDE = np.array([[-0.45, 0.2, 0.0], [-0.45, -0.2, 0.0]])
"""Room for 0.8 m straight ahead."""


def straight(step: int) -> tuple[float, float]:
    return FULL, FULL


def spin(step: int) -> tuple[float, float]:
    return -4.0, 4.0


def rest(step: int) -> tuple[float, float]:
    return 0.0, 0.0


@dataclass(frozen=True)
class Path:
    """Rows are control steps, then robots (0 healthy, 1 affected)."""

    true: FloatArray
    """(steps + 1, 2, 3)."""
    measured: FloatArray
    """(steps + 1, 2, 3)."""
    encoders: FloatArray
    """(steps + 1, 2, 2) rad/s."""

    @property
    def ahead(self) -> FloatArray:
        """(steps + 1, 2) m that each robot has moved along x."""
        return self.true[:, :, 0] - self.true[0, :, 0]

    @property
    def turned(self) -> FloatArray:
        """(steps + 1, 2) rad."""
        yaw = np.unwrap(self.true[:, :, 2], axis=0)
        return yaw - yaw[0]


def world_of(robots: int, *specs: str, seed: int = 1, poses: FloatArray | None = None) -> World:
    """A world with something hidden in it."""
    return World(
        robots,
        np.random.SeedSequence(seed),
        effects=parse_effects(specs, robots),
        poses=poses,
        engine=ENGINE,
    )


def drive(
    commands: Commands, seconds: float, *specs: str, poses: FloatArray = SIDE_BY_SIDE
) -> Path:
    """Both robots obey the same commands for a while."""
    robots = len(poses)
    world = world_of(robots, *specs, poses=poses)
    steps = round(seconds / STEP)
    true, measured = np.empty((steps + 1, robots, 3)), np.empty((steps + 1, robots, 3))
    encoders = np.empty((steps + 1, robots, 2))
    for step in range(steps + 1):
        world.sense()
        world.read_encoders()
        true[step], measured[step] = world.poses, world.tracker.poses
        encoders[step] = world.encoders.speeds
        world.act(np.tile(np.array(commands(step)), (robots, 1)))
    world.close()
    return Path(true, measured, encoders)


def readings(*specs: str, poses: FloatArray, scenario: int = 1, repeats: int = 400) -> Readings:
    """What robots at rest read, many times over; `scenario` as in `embedded_sim.SCENARIOS`."""
    robots = len(poses)
    world = world_of(robots, *specs, poses=poses)
    world.light.set_scenario(scenario)
    ps, ls = np.empty((repeats, robots, 8)), np.empty((repeats, robots, 8))
    for i in range(repeats):
        world.sense()
        ps[i], ls[i] = world.infrared.counts, world.light.counts
        world.time_step += 1
    world.close()
    return Readings(ps, ls)


@dataclass(frozen=True)
class Readings:
    """(repeats, robots, 8) counts; no robot moves, and a control step passes between readings."""

    ps: FloatArray
    ls: FloatArray

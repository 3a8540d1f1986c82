"""What the world asks of a physics engine, and the engines that can be asked.

Each is the only module that talks to its library, and is imported when it is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Literal, Protocol, cast, get_args

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.reality import constants as k
from realitygap.reality.rays import Rays

FloatArray = npt.NDArray[np.float64]

EngineName = Literal["pybullet", "pybullet-strict", "mujoco"]
ENGINES: tuple[EngineName, ...] = get_args(EngineName)
DEFAULT: EngineName = "pybullet"
MISSING: dict[str, str] = {
    "pybullet": "pybullet to be installed, which Python 3.11 has and later ones have not; "
    "or --engine mujoco, with the extra [mujoco]",
    "mujoco": "the extra [mujoco] to be installed",
}
"""What is expected where an engine's library is not there, by library."""
_CLASSES: dict[EngineName, tuple[str, str]] = {
    "pybullet": ("pybullet", "PybulletEngine"),
    "pybullet-strict": ("pybullet", "StrictPybulletEngine"),
    "mujoco": ("mujoco", "MujocoEngine"),
}
"""Library and class of each."""


class Engine(Rays, Protocol):
    """One physics world of one process: a level floor, a wall, robots numbered as they are added.

    Rebuilt for every run: that is what makes it repeatable. All is built before the first step.
    """

    def __init__(
        self,
        *,
        step: float = k.PHYSICS_STEP,
        iterations: int | None = None,
        gravity: tuple[float, float, float] = (0.0, 0.0, -k.GRAVITY),
    ) -> None:
        """Open an empty world with a floor.

        Args:
            step: s of physics per `advance`.
            iterations: of the contact and motor solver, at most; None: the engine's own choice.
            gravity: m/s^2.
        """

    def close(self) -> None:
        """Free the world."""

    def add_ring(self, radius: float = k.ARENA_RADIUS) -> None:
        """The arena's circular wall: `WALL_FACETS` whose middles touch the circle (m)."""

    def add_epuck(
        self,
        pose: Sequence[float],
        *,
        wheel_radius: Sequence[float] = (k.WHEEL_RADIUS, k.WHEEL_RADIUS),
        axle: float = k.AXLE,
        wheel_friction: float = k.WHEEL_FRICTION,
    ) -> None:
        """A robot with the middle of its axle at pose (x, y, yaw); wheels stand on the floor."""

    def drive(self, robot: int, left: float, right: float, torque: float) -> None:
        """Set the speeds (rad/s) that a robot's two motors hold with at most `torque` (N m)."""

    def advance(self, steps: int) -> None:
        """Step the physics."""

    def poses(self, out: FloatArray) -> None:
        """Fill (robots, 3): x, y (m) and yaw (rad) of the middles of the axles."""

    def wheel_angles(self, out: FloatArray) -> None:
        """Fill (robots, 2): rad that the left and right wheel have turned against the body."""


def engine_name(word: str, *, needed: bool = True) -> EngineName:
    """An engine that can be used.

    Args:
        word: Its name.
        needed: Whether there is anything for it to do; otherwise its library may be missing.

    Raises:
        InputError: no such engine, or its library is not installed.
    """
    if word not in ENGINES:
        raise InputError("--engine", repr(word), nearest(word, ENGINES))
    if needed and not installed(word):
        raise InputError("--engine", repr(word), MISSING[_CLASSES[word][0]])
    return word


def installed(name: EngineName) -> bool:
    """Whether an engine's library is there."""
    return find_spec(_CLASSES[name][0]) is not None


def engine_class(name: str) -> type[Engine]:
    """The class of an engine.

    Raises:
        InputError: no such engine, or its library is not installed.
    """
    library, kind = _CLASSES[engine_name(name)]
    module = import_module(f"realitygap.reality.{library}_engine")
    return cast("type[Engine]", getattr(module, kind))

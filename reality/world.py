"""Reality: ten rigid robots in an arena with a lamp, a tracker and a radio.

Every 40 ms the caller senses, lets the controllers answer, and advances. Nothing here knows what a
robot believes.

The encoders count what the wheels really turned, in whole steps; a late tracker reports poses of
some time ago.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.embedded_sim.errors import Diverged, InputError
from realitygap.reality import constants as k
from realitygap.reality.arena import ForagingArena
from realitygap.reality.effects.spec import HiddenEffect
from realitygap.reality.engine import DEFAULT, Engine, engine_class
from realitygap.reality.hardware import NOMINAL, Build, FloatArray, Hardware
from realitygap.reality.motors import SUBSTEPS, Motors
from realitygap.reality.rays import DEFAULT_RAYS, ClosedRays, Rays, RaysName
from realitygap.reality.senses import Infrared, Light, Radio, Tracker


class Past:
    """The robots' poses at the last physics steps, and between two of them on a straight line."""

    def __init__(self, delay: FloatArray, poses: FloatArray) -> None:
        """Remember as far back as the latest clock needs.

        Args:
            delay: (robots,) s.
            poses: (robots, 3) where the robots are, and have always been.
        """
        steps = delay / k.PHYSICS_STEP
        whole = np.floor(steps + 1e-9)
        self._whole, self._part = whole.astype(np.intp), np.maximum(steps - whole, 0.0)[:, None]
        self._poses: FloatArray = np.repeat(poses[None], int(self._whole.max()) + 2, axis=0)
        self._rows = np.arange(len(delay))
        self._newest = 0

    def add(self, poses: FloatArray) -> None:
        """A physics step later the robots are at poses (robots, 3)."""
        self._newest += 1
        self._poses[self._newest % len(self._poses)] = poses

    def late(self) -> FloatArray:
        """(robots, 3): where each robot was when its clock says it is now."""
        at = self._newest - self._whole
        later = self._poses[at % len(self._poses), self._rows]
        back = self._poses[(at - 1) % len(self._poses), self._rows] - later
        back[:, 2] = np.remainder(back[:, 2] + np.pi, 2.0 * np.pi) - np.pi
        return later + self._part * back


class Encoders:
    """Step counters on both wheels of every robot, read once per control step."""

    def __init__(self, robots: int) -> None:
        self.speeds: FloatArray = np.zeros((robots, 2))
        """rad/s, left and right: the mean over the control step that ends now, of whole steps."""
        self._angles: FloatArray = np.zeros((robots, 2))
        self._steps: FloatArray = np.zeros((robots, 2))

    def read(self, engine: Engine) -> None:
        """Fill `speeds` from the steps counted since the last reading."""
        engine.wheel_angles(self._angles)
        steps = np.rint(self._angles / k.WHEEL_STEP)
        np.subtract(steps, self._steps, out=self.speeds)
        self.speeds *= k.WHEEL_STEP / k.CONTROL_STEP
        self._steps = steps


class World:
    """The physical swarm; all arrays have one row per robot."""

    def __init__(
        self,
        robots: int,
        seed: np.random.SeedSequence,
        *,
        effects: Sequence[HiddenEffect] = (),
        poses: FloatArray | None = None,
        lamp_power: float = k.LAMP_POWER,
        build: Build | None = None,
        engine: str = DEFAULT,
        rays: RaysName = DEFAULT_RAYS,
        arena: ForagingArena = NOMINAL,
    ) -> None:
        """Build the arena and put the robots down.

        Args:
            robots: How many.
            seed: Spawned by purpose: places, food, infrared, light, tracker.
            effects: What to hide in it.
            poses: (robots, 3) m, m, rad to start from; drawn at random when absent.
            lamp_power: counts m^2.
            build: How the robots differ; None: they are all alike.
            engine: Name of the physics engine.
            rays: Who answers what infrared meets.
            arena: Where they forage.

        Raises:
            InputError: the robots do not fit into the arena, or the engine is not installed.
        """
        places, food, infrared, light, tracker = (
            np.random.default_rng(child) for child in seed.spawn(5)
        )
        hardware = Hardware.nominal(robots, arena)
        hardware.lamp.power = lamp_power
        for hidden in effects:
            hidden.hide(hardware)
        if build is not None:
            build.apply(hardware)
        self.robots = robots
        self.poses: FloatArray = (
            scatter(robots, places, arena.radius) if poses is None else poses.copy()
        )
        self.infrared = Infrared(hardware, infrared)
        self.light = Light(hardware, light)
        self.tracker = Tracker(hardware, tracker)
        self.radio = Radio(robots)
        self.time_step = 0
        self.motors = Motors(hardware)
        self.encoders = Encoders(robots)
        self._past = Past(hardware.clock_delay, self.poses) if hardware.clock_delay.any() else None
        self._passed: FloatArray = np.zeros((robots, 3))
        self._food_random = food
        for item in range(arena.food_items):
            self.tracker.place_food(item, food)
        self.engine = engine_class(engine)(gravity=hardware.gravity)
        self.engine.add_ring(arena.radius)
        closed = rays == "closed"
        self._rays: Rays = ClosedRays(self.poses, arena.radius) if closed else self.engine
        for i in range(robots):
            self.engine.add_epuck(
                self.poses[i].tolist(),
                wheel_radius=hardware.wheel_radius[i].tolist(),
                axle=float(hardware.axle[i]),
                wheel_friction=float(hardware.wheel_friction[i]),
            )

    def close(self) -> None:
        """Free the physics engine."""
        self.engine.close()

    def sense(self) -> None:
        """Fill `infrared.counts`, `light.counts` and the tracker's measured poses."""
        self.engine.poses(self.poses)
        if not np.isfinite(self.poses).all():
            robot = int(np.argmin(np.isfinite(self.poses).all(axis=1)))
            raise Diverged(f"the physics diverged at step {self.time_step}, robot {robot}")
        self.infrared.sense(self._rays, self.poses)
        self.light.sense(self.poses, self.time_step * k.CONTROL_STEP)
        self.tracker.measure(self.poses if self._past is None else self._past.late())

    def read_encoders(self) -> None:
        """Fill `encoders.speeds`; call it at every control step or not at all."""
        self.encoders.read(self.engine)

    def replace_food(self, robot: int) -> None:
        """The robot has taken the item it is on; a new one appears elsewhere."""
        self.tracker.place_food(int(self.tracker.item[robot]), self._food_random)

    def act(self, commands: FloatArray) -> None:
        """Send wheel speeds (robots, 2) in rad/s to the motors and advance one control step."""
        self.motors.command(self.engine, commands)
        if self.motors.chain is None and self._past is None:
            self.engine.advance(SUBSTEPS)
        else:
            for substep in range(SUBSTEPS):
                self.motors.drive(self.engine, substep, self.poses)
                self.engine.advance(1)
                if self._past is not None:
                    self.engine.poses(self._passed)
                    self._past.add(self._passed)
        self.time_step += 1


def scatter(robots: int, random: np.random.Generator, radius: float = k.ARENA_RADIUS) -> FloatArray:
    """Random poses (robots, 3) in an arena, 5 mm and more between bodies and to the wall.

    Raises:
        InputError: no room found.
    """
    gap = 0.005
    reach = radius - k.BODY_RADIUS - gap
    poses = np.zeros((robots, 3))
    placed = 0
    for _ in range(2000 * robots):
        if placed == robots:
            break
        far, angle = reach * np.sqrt(random.random()), 2.0 * np.pi * random.random()
        x, y = far * np.cos(angle), far * np.sin(angle)
        apart = np.hypot(poses[:placed, 0] - x, poses[:placed, 1] - y)
        if placed == 0 or apart.min() > 2.0 * k.BODY_RADIUS + gap:
            poses[placed] = x, y, np.pi * (2.0 * random.random() - 1.0)
            placed += 1
    if placed < robots:
        raise InputError("--robots", robots, f"at most about {placed}: more do not fit the arena")
    return poses

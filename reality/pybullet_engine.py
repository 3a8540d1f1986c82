"""The only module that talks to pybullet: bodies in, centres of mass and ray hits out.

pybullet is frozen upstream (3.2.7) and untyped; what we learnt of its habits is settled here.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.reality import constants as k
from realitygap.reality._optics import ffi, lib
from realitygap.reality.senses import doubles


@contextmanager
def _silence() -> Iterator[None]:
    """pybullet prints its build time to stderr, from C, when it is imported; nobody asked."""
    sys.stderr.flush()
    saved = os.dup(2)
    try:
        with open(os.devnull, "wb") as null:
            os.dup2(null.fileno(), 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)


with _silence():
    import pybullet as bullet

FloatArray = npt.NDArray[np.float64]

# Who collides with whom: wheels and skids only touch the floor, bodies walls and one another.
# A wheel is a sphere and sticks out of the body; no ray and no neighbour may meet it.
# A ray's own group is always 1, which whatever it may hit must have in its mask.
_RAY, _FLOOR, _WALL, _BODY, _WHEEL = 1, 2, 4, 8, 16
_LEFT, _RIGHT = 0, 1
_FACET = 2.0 * math.pi / k.WALL_FACETS
_RING_NORMALS = [(-math.cos(i * _FACET), -math.sin(i * _FACET)) for i in range(k.WALL_FACETS)]
_PARTS = 15  # of one body: the engine refuses more than 16
_BASE = -1
_CENTRE: FloatArray = np.array(k.CENTRE_OF_MASS)


class PybulletEngine:
    """An `Engine`."""

    _ITERATIONS = k.SOLVER_ITERATIONS
    _SLOP: float | None = None
    """m by which contacts may overlap unpunished; None: the engine's own."""

    def __init__(
        self,
        *,
        step: float = k.PHYSICS_STEP,
        iterations: int | None = None,
        gravity: tuple[float, float, float] = (0.0, 0.0, -k.GRAVITY),
    ) -> None:
        self._back = 0.5 * step  # s before its end is the middle of a step
        self._client: int = bullet.connect(bullet.DIRECT)
        self._bodies: list[int] = []
        self._ring: set[int] = set()  # bodies of a ring around the origin
        bullet.setPhysicsEngineParameter(
            fixedTimeStep=step,
            numSolverIterations=self._ITERATIONS if iterations is None else iterations,
            contactBreakingThreshold=k.CONTACT_THRESHOLD,
            deterministicOverlappingPairs=1,
            enableConeFriction=1,
            physicsClientId=self._client,
        )
        if self._SLOP is not None:
            bullet.setPhysicsEngineParameter(contactSlop=self._SLOP, physicsClientId=self._client)
        bullet.setGravity(*gravity, physicsClientId=self._client)
        floor = self._body(0.0, self._shape(bullet.GEOM_PLANE))
        self._collide(floor, _BASE, _FLOOR, _WHEEL)
        self._dynamics(floor, _BASE, lateralFriction=1.0)

    def close(self) -> None:
        if self._client >= 0:
            bullet.disconnect(self._client)
            self._client = -1

    def add_ring(self, radius: float = k.ARENA_RADIUS) -> None:
        """The arena's circular wall: facets, in as few bodies as the engine takes.

        The engine visits every body at every step, the parts of a body only where something is
        near.
        """
        half = 0.5 * k.WALL_THICKNESS
        length = 2.0 * (radius + k.WALL_THICKNESS) * math.tan(math.pi / k.WALL_FACETS)
        facet = [half, 0.5 * length, 0.5 * k.WALL_HEIGHT]
        for first in range(0, k.WALL_FACETS, _PARTS):
            yaws = [
                2.0 * math.pi * i / k.WALL_FACETS
                for i in range(first, min(first + _PARTS, k.WALL_FACETS))
            ]
            arc = bullet.createCollisionShapeArray(
                shapeTypes=[bullet.GEOM_BOX] * len(yaws),
                halfExtents=[facet] * len(yaws),
                collisionFramePositions=[
                    [
                        (radius + half) * math.cos(yaw),
                        (radius + half) * math.sin(yaw),
                        0.5 * k.WALL_HEIGHT,
                    ]
                    for yaw in yaws
                ],
                collisionFrameOrientations=[
                    bullet.getQuaternionFromEuler([0.0, 0.0, yaw]) for yaw in yaws
                ],
                physicsClientId=self._client,
            )
            wall = self._body(0.0, arc)
            self._collide(wall, _BASE, _WALL, _BODY | _RAY)
            self._ring.add(wall)
            self._dynamics(wall, _BASE, lateralFriction=1.0)

    def add_epuck(
        self,
        pose: Sequence[float],
        *,
        wheel_radius: Sequence[float] = (k.WHEEL_RADIUS, k.WHEEL_RADIUS),
        axle: float = k.AXLE,
        wheel_friction: float = k.WHEEL_FRICTION,
    ) -> None:
        lift = k.WHEEL_RADIUS  # the base frame: middle of a nominal robot's axle
        height = k.BODY_TOP - k.BODY_BOTTOM
        body = self._shape(
            bullet.GEOM_CYLINDER,
            radius=k.BODY_RADIUS,
            height=height,
            collisionFramePosition=[0.0, 0.0, k.BODY_BOTTOM + 0.5 * height - lift],
        )
        wheels = [self._shape(bullet.GEOM_SPHERE, radius=radius) for radius in wheel_radius]
        skid = self._shape(bullet.GEOM_SPHERE, radius=k.SKID_RADIUS)
        links = 3
        places = [
            [0.0, 0.5 * axle, wheel_radius[_LEFT] - lift],
            [0.0, -0.5 * axle, wheel_radius[_RIGHT] - lift],
            [k.SKID, 0.0, k.SKID_RADIUS + k.SKID_CLEARANCE - lift],
        ]
        masses = [k.WHEEL_MASS, k.WHEEL_MASS, k.SKID_MASS]
        com = k.CENTRE_OF_MASS
        robot = self._body(
            k.MASS - sum(masses),
            body,
            basePosition=[pose[0], pose[1], lift],
            baseOrientation=bullet.getQuaternionFromEuler([0.0, 0.0, pose[2]]),
            baseInertialFramePosition=[com[0], com[1], com[2] - lift],
            linkMasses=masses,
            linkCollisionShapeIndices=[*wheels, skid],
            linkVisualShapeIndices=[-1] * links,
            linkPositions=places,
            linkOrientations=[[0.0, 0.0, 0.0, 1.0]] * links,
            linkInertialFramePositions=[[0.0, 0.0, 0.0]] * links,
            linkInertialFrameOrientations=[[0.0, 0.0, 0.0, 1.0]] * links,
            linkParentIndices=[0] * links,
            linkJointTypes=[bullet.JOINT_REVOLUTE, bullet.JOINT_REVOLUTE, bullet.JOINT_FIXED],
            linkJointAxis=[[0.0, 1.0, 0.0]] * links,
        )
        self._collide(robot, _BASE, _BODY, _WALL | _BODY | _RAY)
        self._dynamics(robot, _BASE, lateralFriction=k.BODY_FRICTION)
        for link in range(links):
            self._collide(robot, link, _WHEEL, _FLOOR)
            friction = wheel_friction if link in (_LEFT, _RIGHT) else 0.0
            self._dynamics(robot, link, lateralFriction=friction)
        for link in (_LEFT, _RIGHT):
            bare = 0.4 * k.WHEEL_MASS * wheel_radius[link] ** 2  # of a sphere
            self._dynamics(robot, link, localInertiaDiagonal=[bare, k.WHEEL_INERTIA, bare])
        for link in range(-1, links):
            self._dynamics(robot, link, linearDamping=0.0)
            self._dynamics(robot, link, angularDamping=0.0)
            self._dynamics(robot, link, jointDamping=0.0)
        self._bodies.append(robot)

    def drive(self, robot: int, left: float, right: float, torque: float) -> None:
        bullet.setJointMotorControlArray(
            self._bodies[robot],
            (_LEFT, _RIGHT),
            bullet.VELOCITY_CONTROL,
            targetVelocities=(left, right),
            forces=(torque, torque),
            physicsClientId=self._client,
        )

    def advance(self, steps: int) -> None:
        client = self._client
        for _ in range(steps):
            bullet.stepSimulation(client)

    def wheel_angles(self, out: FloatArray) -> None:
        client = self._client
        wheels = (_LEFT, _RIGHT)
        states = [bullet.getJointStates(body, wheels, client) for body in self._bodies]
        out[:] = [(left[0], right[0]) for left, right in states]

    def poses(self, out: FloatArray) -> None:
        client = self._client
        bodies = [bullet.getBasePositionAndOrientation(body, client) for body in self._bodies]
        raw: FloatArray = np.array([position + orientation for position, orientation in bodies])
        speeds = self._speeds()
        moving = ffi.NULL if speeds is None else doubles(speeds)
        lib.rgo_poses(len(raw), doubles(raw), moving, self._back, doubles(_CENTRE), doubles(out))

    def _speeds(self) -> FloatArray | None:
        """(robots, 6) m/s and rad/s of the centres of mass; None: poses need none."""
        return None

    def cast(
        self,
        start: FloatArray,
        end: FloatArray,
        fraction: FloatArray,
        normals: FloatArray,
        on_robot: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """Cast rays (n, 3) in one batch against walls and bodies.

        Fills `fraction` (n,), 1 where nothing is hit, `normals` (n, 2), x and y of the surface,
        and, if given, `on_robot` (n,): whether it is a robot that was hit. A wall's normal is its
        face's: within a millimetre of a joint the engine's own is that of a box's edge, up to
        20 deg off.
        """
        hits: Any = bullet.rayTestBatch(  # it reads lists faster than arrays
            start.tolist(),
            end.tolist(),
            collisionFilterMask=_WALL | _BODY,
            physicsClientId=self._client,
        )
        fraction[: len(hits)] = [hit[2] if hit[0] >= 0 else 1.0 for hit in hits]
        normals[: len(hits)] = [self._normal(*hit) for hit in hits]
        if on_robot is not None:
            on_robot[: len(hits)] = [hit[0] in self._bodies for hit in hits]

    def _normal(
        self, body: int, _link: int, _share: float, place: Any, normal: Any
    ) -> Sequence[float]:
        """x and y of the normal of a surface that a ray met."""
        if body in self._ring:
            facet = round(math.atan2(place[1], place[0]) / _FACET)
            return _RING_NORMALS[facet % k.WALL_FACETS]
        return normal[:2]  # type: ignore[no-any-return]

    def _shape(self, kind: int, **size: Any) -> int:
        shape: int = bullet.createCollisionShape(kind, physicsClientId=self._client, **size)
        return shape

    def _body(self, mass: float, shape: int, **build: Any) -> int:
        body: int = bullet.createMultiBody(mass, shape, physicsClientId=self._client, **build)
        return body

    def _collide(self, body: int, link: int, group: int, mask: int) -> None:
        bullet.setCollisionFilterGroupMask(body, link, group, mask, self._client)

    def _dynamics(self, body: int, link: int, **value: Any) -> None:
        """One property a call: several at once land on the base."""
        bullet.changeDynamics(body, link, physicsClientId=self._client, **value)


class StrictPybulletEngine(PybulletEngine):
    """An `Engine`: pybullet at settings that keep its artefacts within bounds.

    Poses and wheel angles are those of the middle of a step, for positions move with the velocity
    at a step's end. Contacts leave no slop, from whose edge wheels pushed robots along by
    themselves. See docs/convergence.md.
    """

    _ITERATIONS = k.STRICT_ITERATIONS
    _SLOP = k.STRICT_SLOP

    def wheel_angles(self, out: FloatArray) -> None:
        client, wheels, back = self._client, (_LEFT, _RIGHT), self._back
        states = [bullet.getJointStates(body, wheels, client) for body in self._bodies]
        out[:] = [[wheel[0] - back * wheel[1] for wheel in state] for state in states]

    def _speeds(self) -> FloatArray:
        """(robots, 6) m/s and rad/s of the centres of mass."""
        client = self._client
        speeds = [bullet.getBaseVelocity(body, client) for body in self._bodies]
        return np.array([linear + angular for linear, angular in speeds])

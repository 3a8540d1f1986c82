"""The only module that talks to MuJoCo: bodies in, poses and ray hits out.

Wheels roll on dry friction, a motor is dry friction against a housing that turns, and all is solved
at once by Newton's method. Poses and angles are those of the middle of a step: the engine moves
bodies with the velocity at a step's end, so that positions run half a step ahead of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from realitygap.reality import constants as k
from realitygap.reality.rays import OUTWARD, ClosedRays

FloatArray = npt.NDArray[np.float64]

TOLERANCE = 1e-8
"""Relative change at which the solver stops: MuJoCo's own."""
mujoco.set_mju_user_warning(lambda text: None)  # or each goes to stderr and into MUJOCO_LOG.TXT

RIGID = 0.999
"""Share of a force that motors and contacts do not yield to. At MuJoCo's 0.9 robots turn too
little."""
STOP = 0.95
"""Share of a speed towards a contact, of a slip along it and of a depth that a step takes away; our
choice: all but all. Wheels sink by a micrometre; a softer floor shows in straights."""
FLOOR_REACH, BODY_REACH = 1e-3, 3e-3
"""m from which a contact slows what approaches, so that it arrives as they touch: more than
anything comes nearer in a step. MuJoCo's own contacts begin with an overlap, from which robots that
rock between wheels and skid would go on rattling."""
FREE = 1e-12
"""N m: the torque of a motor that was never driven; with none its row would be gone."""

_GHOST: dict[str, Any] = {"contype": 0, "conaffinity": 0}
"""Meets nothing but what it is paired with."""
_HELD = [RIGID, RIGID, 1.0, 0.5, 2.0]
"""The same however deep; the other three would shape how it grew."""
_SKID, _LEFT, _RIGHT = "skid", "left", "right"
_POSITIONS, _SPEEDS = 9, 8
"""Of one robot: the free body's seven and six, and its wheels' angles."""
_FACET = 2.0 * math.pi * np.arange(k.WALL_FACETS) / k.WALL_FACETS
_C, _S = np.cos(0.5 * _FACET), np.sin(0.5 * _FACET)
_INWARD = math.sqrt(0.5) * np.stack([_C, _S, -_C, _S], axis=1)
"""Quaternions (w, x, y, z) that turn the z axis to each facet's inward normal."""


class MujocoEngine:
    """An `Engine`; it is compiled when something is first asked of it."""

    def __init__(
        self,
        *,
        step: float = k.PHYSICS_STEP,
        iterations: int | None = None,
        gravity: tuple[float, float, float] = (0.0, 0.0, -k.GRAVITY),
    ) -> None:
        self._step = step
        self._spec = mujoco.MjSpec()
        option = self._spec.option
        option.timestep, option.gravity = step, gravity
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        option.iterations = k.NEWTON_ITERATIONS if iterations is None else iterations
        option.ls_iterations = k.NEWTON_ITERATIONS  # few are wrong as well
        option.tolerance = TOLERANCE
        # what diverges is to be seen, not put back to where it began
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        _plane(self._spec.worldbody, "floor")
        self._frictions: list[float] = []
        self._ring: float | None = None
        self._model: Any = None
        self._data: Any = None

    def close(self) -> None:
        self._model = self._data = None

    def add_ring(self, radius: float = k.ARENA_RADIUS) -> None:
        """The arena's circular wall, of which each robot meets the facet next to it."""
        self._ring = radius

    def add_epuck(
        self,
        pose: Sequence[float],
        *,
        wheel_radius: Sequence[float] = (k.WHEEL_RADIUS, k.WHEEL_RADIUS),
        axle: float = k.AXLE,
        wheel_friction: float = k.WHEEL_FRICTION,
    ) -> None:
        lift = k.WHEEL_RADIUS  # the base frame: middle of a nominal robot's axle
        n = len(self._frictions)
        body = self._spec.worldbody.add_body(
            pos=[pose[0], pose[1], lift],
            quat=[math.cos(0.5 * pose[2]), 0.0, 0.0, math.sin(0.5 * pose[2])],
            mass=k.MASS - 2.0 * k.WHEEL_MASS - k.SKID_MASS,
            ipos=[*k.CENTRE_OF_MASS[:2], k.CENTRE_OF_MASS[2] - lift],
            inertia=k.BODY_INERTIA,
            explicitinertial=True,
        )
        body.add_freejoint()
        body.add_geom(  # met from the side alone, where it is the cylinder that a robot is
            name=f"body{n}",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            size=[k.BODY_RADIUS, 0.0, 0.0],
            fromto=[0.0, 0.0, k.BODY_BOTTOM - lift, 0.0, 0.0, k.BODY_TOP - lift],
            **_GHOST,
        )
        skid = [k.SKID, 0.0, k.SKID_RADIUS + k.SKID_CLEARANCE - lift]
        _ball(body, f"{_SKID}{n}", skid, k.SKID_RADIUS, k.SKID_MASS)
        places = [0.0, 0.5 * axle, 0.0], [0.0, -0.5 * axle, 0.0]
        for side, radius, place in zip((_LEFT, _RIGHT), wheel_radius, places, strict=True):
            place[2] = radius - lift
            wheel = _ball(body, f"{side}{n}", place, radius, k.WHEEL_MASS)
            wheel.add_joint(
                type=mujoco.mjtJoint.mjJNT_HINGE,
                axis=[0.0, 1.0, 0.0],
                armature=k.WHEEL_INERTIA - 0.4 * k.WHEEL_MASS * radius**2,
                frictionloss=FREE,
                solref_friction=[2.0 * self._step, 1.0],
                solimp_friction=_HELD,
            )
        self._frictions.append(wheel_friction)

    def drive(self, robot: int, left: float, right: float, torque: float) -> None:
        self._build()
        wheels = slice(2 * robot, 2 * robot + 2)
        self._housing[wheels] = left, right
        self._housing[wheels] /= RIGID * self._step
        self._torque[robot] = torque

    def advance(self, steps: int) -> None:
        self._build()
        model, data, motors = self._model, self._data, len(self._housing)
        for _ in range(steps):
            if self._ring is not None:
                self._turn_walls(self._ring)
            mujoco.mj_step1(model, data)
            asked, spring = data.efc_aref, data.efc_KBIP  # m/s^2 or rad/s^2 of every constraint
            asked[:motors] += self._housing
            # a contact pushes from where it reaches to; it is to push from touch
            asked -= spring[:, 0] * spring[:, 2] * data.efc_margin
            mujoco.mj_step2(model, data)

    def poses(self, out: FloatArray) -> None:
        self._build()
        place, speed, half = self._place, self._speed, 0.5 * self._step
        w, x, y, z = place[:, 3:7].T
        yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        out[:, :2] = place[:, :2] - half * speed[:, :2]
        out[:, 2] = np.remainder(yaw - half * speed[:, 5] + np.pi, 2.0 * np.pi) - np.pi

    def wheel_angles(self, out: FloatArray) -> None:
        self._build()
        out[:] = self._place[:, 7:] - 0.5 * self._step * self._speed[:, 6:]

    def cast(
        self,
        start: FloatArray,
        end: FloatArray,
        fraction: FloatArray,
        normals: FloatArray,
        on_robot: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """As `Rays`, in closed form."""
        poses = np.empty((len(self._frictions), 3))
        self.poses(poses)
        ClosedRays(poses, self._ring).cast(start, end, fraction, normals, on_robot)

    def _build(self) -> None:
        """Say what meets what, and compile; once."""
        if self._model is not None:
            return
        floor = {"margin": FLOOR_REACH}
        if self._ring is not None:
            for n in range(len(self._frictions)):
                wall = self._spec.worldbody.add_body(mocap=True)
                _plane(wall, f"wall{n}")
        for n, friction in enumerate(self._frictions):
            self._pair(f"{_SKID}{n}", "floor", condim=1, **floor)
            for side in (_LEFT, _RIGHT):
                self._pair(f"{side}{n}", "floor", friction=[friction] * 2 + [0.0] * 3, **floor)
            if self._ring is not None:
                self._meet(f"body{n}", f"wall{n}", k.BODY_FRICTION)
            for other in range(n):
                self._meet(f"body{n}", f"body{other}", k.BODY_FRICTION**2)
        self._model = self._spec.compile()
        self._data = mujoco.MjData(self._model)
        robots = len(self._frictions)
        self._place = self._data.qpos.reshape(robots, _POSITIONS)
        self._speed = self._data.qvel.reshape(robots, _SPEEDS)
        self._torque = self._model.dof_frictionloss.reshape(robots, _SPEEDS)[:, 6:]
        self._housing: FloatArray = np.zeros(2 * robots)

    def _meet(self, one: str, other: str, friction: float) -> None:
        """A body meets another, or a wall."""
        self._pair(one, other, margin=BODY_REACH, friction=[friction] * 2 + [0.0] * 3)

    def _pair(self, one: str, other: str, **contact: Any) -> None:
        """What touches; MuJoCo takes stiffness and damping as negative numbers."""
        stopped = [-STOP / self._step**2, -STOP / self._step]
        self._spec.add_pair(
            geomname1=one, geomname2=other, solref=stopped, solimp=_HELD, **{"condim": 3, **contact}
        )

    def _turn_walls(self, radius: float) -> None:
        """Put the wall of each robot where the facet next to it is."""
        bearing = np.arctan2(self._place[:, 1], self._place[:, 0])
        with np.errstate(invalid="ignore"):  # a robot lost to divergence is next to any
            facet = np.rint(bearing / _FACET[1]).astype(np.intp) % k.WALL_FACETS
        self._data.mocap_pos[:, :2] = radius * OUTWARD[facet]
        self._data.mocap_quat[:] = _INWARD[facet]


def _plane(body: Any, name: str) -> None:
    """A solid half of the world below a body's origin."""
    body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1.0, 1.0, 1.0], **_GHOST)


def _ball(body: Any, name: str, place: list[float], radius: float, mass: float) -> Any:
    """A ball of some mass (kg) as a new part of a body."""
    part = body.add_body(pos=place)
    size = [radius, 0.0, 0.0]
    part.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=size, mass=mass, **_GHOST)
    return part

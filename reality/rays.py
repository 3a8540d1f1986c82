"""Who answers what the infrared's rays meet: the physics engine, or a closed form.

The closed form knows what the arena is made of: upright cylinders and the straight facets of its
wall. It is exact (`rgo_cast` in `reality/optics`); an engine answers by its own collision shapes.
"""

from __future__ import annotations

import math
from typing import Literal, Protocol, get_args

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.reality import constants as k
from realitygap.reality._optics import ffi, lib

FloatArray = npt.NDArray[np.float64]

RaysName = Literal["engine", "closed"]
RAYS: tuple[RaysName, ...] = get_args(RaysName)
DEFAULT_RAYS: RaysName = "closed"
"""What the shipped tables and references were measured with."""

_FACET = 2.0 * math.pi * np.arange(k.WALL_FACETS) / k.WALL_FACETS
OUTWARD = np.stack([np.cos(_FACET), np.sin(_FACET)], axis=1)
"""(facets, 2): the outward normals of the arena's wall."""


class Rays(Protocol):
    """Whoever can be asked what rays meet."""

    def cast(
        self,
        start: FloatArray,
        end: FloatArray,
        fraction: FloatArray,
        normals: FloatArray,
        on_robot: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """Cast level rays (n, 3) in one batch against the wall and the robots' bodies.

        Fills `fraction` (n,), 1 where nothing is hit, `normals` (n, 2), x and y of the surface,
        and, if given, `on_robot` (n,): whether it is a robot that was hit. All may be longer.
        """


class ClosedRays:
    """Rays against upright cylinders and flat facets, exactly."""

    def __init__(
        self, poses: FloatArray, wall: float | None, outward: FloatArray = OUTWARD
    ) -> None:
        """
        Args:
            poses: (robots, 3) of the bodies; its owner keeps it up to date.
            wall: m from the origin to the middle of every facet; None: there is no wall.
            outward: (facets, 2) normals of the wall's facets.
        """
        self._poses = poses
        self._outward = outward[:0] if wall is None else outward
        self._wall = wall or 0.0

    def cast(
        self,
        start: FloatArray,
        end: FloatArray,
        fraction: FloatArray,
        normals: FloatArray,
        on_robot: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """As `Rays`; bodies are where `poses` has them now."""
        met = np.empty(len(start), dtype=np.bool_) if on_robot is None else on_robot
        lib.rgo_cast(
            len(start),
            ffi.from_buffer("double[]", start),
            ffi.from_buffer("double[]", end),
            len(self._poses),
            ffi.from_buffer("double[]", self._poses),
            k.BODY_RADIUS,
            len(self._outward),
            ffi.from_buffer("double[]", self._outward),
            self._wall,
            ffi.from_buffer("double[]", fraction),
            ffi.from_buffer("double[]", normals),
            ffi.from_buffer("uint8_t[]", met),
        )


def rays_name(word: str) -> RaysName:
    """Whom to ask, by name.

    Raises:
        InputError: nobody of that name.
    """
    if word not in RAYS:
        raise InputError("--rays", repr(word), nearest(word, RAYS))
    return word

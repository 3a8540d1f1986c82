"""Linear channels with Gaussian errors, whose statistics are known, for the engine of fits.

A toy log is `y = X theta + e`, rows in blocks. Everything that knows how the engine is called is in
this module; the tests speak of logs, terms and blocks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.motion import Motion
from realitygap.models.log.noise import PoseNoise
from realitygap.models.naming.channels.motion.fit import Problem as MotionProblem
from realitygap.models.naming.channels.motion.tracks import BLOCK_WINDOWS, Tracks
from realitygap.models.naming.engine.hypothesis import Term as MotionTerm
from realitygap.models.naming.rules import Rules

MOTION_DEGREES = Rules().row_freedom
WIDE = 1e6
"""Bounds that no toy reaches."""


def parameters(number: int, **more: Any) -> tuple[Parameter, ...]:
    """Numbers of a toy cause; a fit's coordinate is the value."""
    return tuple(
        Parameter(name=f"p{k}", unit="1", null=0.0, low=-WIDE, high=WIDE, step=1.0, **more)
        for k in range(number)
    )


def motion_term(name: str, number: int = 1, **more: Any) -> MotionTerm:
    """A term of motion that makes the column of its name."""
    own = more.pop("own", {})
    cause = Cause(
        name=name,
        meaning=name,
        parameters=parameters(number, **own),
        change=lambda motion, values, variant: motion,
        **more,
    )
    return MotionTerm(cause, "")


def tracks(robots: int, blocks: int, rows: int) -> Tracks:
    """Tracks of so many rows in each block; only how they are cut matters."""
    each, per_window = blocks * rows, rows // BLOCK_WINDOWS
    if per_window * BLOCK_WINDOWS != rows:
        raise ValueError(f"rows: got {rows}, expected a multiple of {BLOCK_WINDOWS}")
    total = robots * each
    return Tracks(
        robots=tuple(range(robots)),
        t=np.tile(0.04 * np.arange(each), robots),
        commands=np.ones((total, 2)),
        start=np.arange(robots + 1) * each,
        segment_robot=np.arange(robots),
        encoders=None,
        rows=np.arange(total),
        first=np.arange(0, total, per_window),
        measured=np.zeros((total, 3)),
        about=np.zeros((total, 0)),
        columns=(),
        noise=PoseNoise(1.0, 1.0),
        step=0.04,
        part=np.zeros(total, dtype=np.int64),
    )


class MotionToy(MotionProblem):
    """The engine of motion on a linear channel."""

    def __init__(
        self, y: FloatArray, columns: Mapping[str, FloatArray], *, together: bool = False
    ) -> None:
        """Prepare.

        Args:
            y: (robots, blocks, rows) errors without any term, in noise.
            columns: (robots, blocks, rows, p) by name of a cause.
            together: All robots have one value of every coordinate; else each its own.
        """
        robots = len(y)
        groups = np.zeros(robots, dtype=np.int64) if together else None
        super().__init__(tracks(*y.shape), [Motion()] * robots, groups=groups)
        self._y = y.ravel()
        self._x = {name: x.reshape(y.size, -1) for name, x in columns.items()}

    def residual(self, terms: Any, coordinates: FloatArray) -> FloatArray:
        """(n, 3) errors, all of them in the first channel."""
        mine = np.asarray(coordinates)[self.groups[self._row_robot]]
        left, at = self._y.copy(), 0
        for cause, _ in terms:
            x = self._x[cause.name]
            left -= (x * mine[:, at : at + x.shape[1]]).sum(axis=1)
            at += x.shape[1]
        return np.column_stack([left, np.zeros((len(left), 2))])


@dataclass(frozen=True)
class Fitted:
    """What an engine says of one term fitted to each of some logs."""

    value: FloatArray
    """(logs, p)."""
    covariance: FloatArray
    """(logs, p, p)."""


def fit_motion(y: FloatArray, x: FloatArray, *, at: FloatArray | None = None) -> Fitted:
    """The engine of motion; each log a robot. `at` (logs, p): coordinates that are not fitted."""
    problem = MotionToy(y, {"x": x})
    term = motion_term("x", x.shape[3])
    start = np.zeros((len(y), x.shape[3]))
    fit = problem.fit((term,), [start]) if at is None else problem.at((term,), at)
    return Fitted(fit.coordinates, fit.covariance)

"""Robust fits of causes to tracks: one Gauss-Newton for all robots at once.

A hypothesis is a tuple of terms; every group of robots has coordinates of its own. Errors are
Student-t; held-out deviances come from the optimum's own curvature (each fold left out in turn
moves the optimum by one Newton step), and covariances from whole blocks of windows, so that neither
trusts rows to be independent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.motion.predict import poses
from realitygap.models.naming.channels.motion.residual import Residuals, deviance, weights
from realitygap.models.naming.channels.motion.tracks import Rows, Tracks
from realitygap.models.naming.engine.hypothesis import Fit, Terms
from realitygap.models.naming.engine.information import inverted

ITERATIONS = 15
"""Gauss-Newton steps of a fit at most. No rule, as all numbers here: tolerances and limits of
iterations."""
CONVERGED = 3e-2
"""Drop of deviance, promised by a further step, at which a robot's fit has ended."""
HOPE = 5.0
"""Times what a step promises to take off that a fit may still come down: far from linear, and with
errors that are seen less wide as they shrink, steps promise too little. Our choice."""
STEADY = 0.1
"""Relative change of the errors' scale between two steps that no longer matters."""
TINY = 1e-9
"""Deviance that is none."""


class Problem:
    """Tracks, what is believed of each robot before any term, and the errors' scale."""

    def __init__(
        self,
        tracks: Tracks,
        base: Sequence[Motion],
        *,
        groups: npt.ArrayLike | None = None,
        scale: FloatArray | None = None,
    ) -> None:
        """Prepare.

        Args:
            tracks: What was measured.
            base: A motion per robot.
            groups: (robots,) index of each robot's group, from 0; None: each robot its own.
            scale: (robots, 3) of the errors, in noise; None: 1.
        """
        self.tracks, self.base = tracks, list(base)
        robots = len(tracks.robots)
        given = np.arange(robots) if groups is None else np.asarray(groups, dtype=np.int64)
        self.groups: Rows = given
        self.count = int(given.max()) + 1
        self.fitter = Residuals(tracks)
        self._row_robot = tracks.robot[tracks.window]
        self.window_group = given[tracks.robot]
        self._windows = len(tracks.first)
        self.scale = np.ones((robots, 3)) if scale is None else scale

    def motions(self, terms: Terms, coordinates: FloatArray) -> list[Motion]:
        """Each robot's motion with the terms at its group's coordinates."""
        result = []
        for robot, motion in enumerate(self.base):
            at = 0
            values = coordinates[self.groups[robot]]
            for cause, variant in terms:
                size = len(cause.parameters)
                motion = cause.applied(motion, values[at : at + size], variant)
                at += size
            result.append(motion)
        return result

    @property
    def scale(self) -> FloatArray:
        """(robots, 3) of the errors, in noise."""
        return self._scale

    @scale.setter
    def scale(self, scale: FloatArray) -> None:
        self._scale = scale
        self.row_scale: FloatArray = scale[self._row_robot]
        """(n, 3) scale of each row's errors."""

    def residual(self, terms: Terms, coordinates: FloatArray) -> FloatArray:
        """(n, 3) errors in noise."""
        return self.fitter(poses(self.tracks, self.motions(terms, coordinates)))

    def losses(self, residual: FloatArray, scale: FloatArray | None = None) -> FloatArray:
        """(windows,) deviance; `scale` (robots, 3) of the errors, the problem's if None."""
        wide = self.row_scale if scale is None else scale[self._row_robot]
        rows = deviance(residual, wide, self.tracks.rules.row_freedom)
        return np.add.reduceat(rows, self.tracks.first)

    def by_group(self, windows: FloatArray) -> FloatArray:
        """(groups, ...) sums over windows."""
        flat = windows.reshape(len(windows), -1)
        total = np.column_stack(
            [np.bincount(self.window_group, flat[:, k], self.count) for k in range(flat.shape[1])]
        )
        return np.asarray(total.reshape(self.count, *windows.shape[1:]), dtype=np.float64)

    def spread(self, residual: FloatArray) -> FloatArray:
        """(robots, 3) robust scale of errors, at least 1: noise is never taken for less."""
        found = np.ones((len(self.tracks.robots), 3))
        edge = np.searchsorted(self._row_robot, np.arange(len(found) + 1))
        for robot in range(len(found)):
            mine = residual[edge[robot] : edge[robot + 1]]
            if len(mine):
                found[robot] = np.maximum(1.0, NORMAL * np.median(np.abs(mine), axis=0))
        return found

    def fit(self, terms: Terms, starts: Sequence[FloatArray]) -> Fit:
        """The best of several starts, each (groups, p).

        Raises:
            Diverged: no start gives finite poses.
        """
        best, lowest, failed = None, np.full(self.count, np.inf), None
        for start in starts:
            try:
                found, loss = self._descend(terms, start, lowest)
            except Diverged as error:
                failed = error
                continue
            better = loss < lowest
            best = found if best is None else np.where(better[:, None], found, best)
            lowest = np.minimum(lowest, loss)
        if best is None:
            raise failed or ValueError("no start")
        return self._finished(terms, best)

    def at(self, terms: Terms, coordinates: FloatArray) -> Fit:
        """The hypothesis at given coordinates, not fitted further."""
        return self._finished(terms, coordinates)

    def _descend(
        self, terms: Terms, start: FloatArray, lowest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Coordinates and deviance per group from one start; wide errors are first seen wide.

        Ends early where no group can hope for less than the deviance `lowest` of other starts.
        """
        bounds = np.array([p.bounds for term in terms for p in term.cause.parameters]).T
        here = np.clip(start, *bounds)
        residual = self.residual(terms, here)
        goal = self.scale
        damping = np.full(self.count, 1e-4)
        jacobian = None
        for _ in range(ITERATIONS if here.shape[1] else 0):
            whole = self.by_group(self.losses(residual, goal))
            before, self.scale = self.scale, np.maximum(goal, self.spread(residual))
            loss = self.by_group(self.losses(residual))
            if jacobian is None:
                jacobian = self.jacobian(terms, here, residual)
            curvature, gradient, _ = self._normal(residual, jacobian)
            step = _solve(curvature, gradient, damping)
            promised = np.einsum("gp,gp->g", step, gradient)
            if (whole * (1.0 - HOPE * promised / np.maximum(loss, TINY)) > lowest).all():
                break
            steady = bool((np.abs(self.scale / before - 1.0) < STEADY).all())
            if (promised < CONVERGED).all() and steady:
                break
            there = np.clip(here - step, *bounds)
            tried = self.residual(terms, there)
            better = self.by_group(self.losses(tried)) < loss
            damping = np.where(better, np.maximum(damping * 0.1, 1e-6), damping * 10.0)
            here = np.where(better[:, None], there, here)
            if not better.any() and (damping > 1e3).all():
                break
            if better.any():
                jacobian = None
                taken = better[self.groups][self._row_robot]
                residual = np.where(taken[:, None], tried, residual)
        self.scale = goal
        return here, self.by_group(self.losses(residual))

    def jacobian(
        self, terms: Terms, here: FloatArray, residual: FloatArray, first: int = 0
    ) -> FloatArray:
        """(n, 3, p) change of the errors per unit of each coordinate from the `first` on."""
        steps = [p.step for term in terms for p in term.cause.parameters]
        smooth = [term.cause.smooth for term in terms for _ in term.cause.parameters]
        columns = []
        for k, (step, follows) in enumerate(zip(steps, smooth, strict=True)):
            if k < first:
                continue
            if not follows:
                columns.append(np.zeros_like(residual))
                continue
            there = here.copy()
            there[:, k] += step
            columns.append((self.residual(terms, there) - residual) / step)
        return np.stack(columns, axis=2) if columns else np.zeros((*residual.shape, 0))

    def _normal(
        self, residual: FloatArray, jacobian: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Curvature (groups, p, p) and gradient (groups, p) of half the deviance.

        Third, the gradient by window.
        """
        w = weights(residual, self.row_scale, self.tracks.rules.row_freedom)
        p = jacobian.shape[2]
        weighted = jacobian * w[:, :, None]
        slope = np.einsum("ncp,nc->np", weighted, residual)
        bend = np.einsum("ncp,ncq->npq", weighted, jacobian).reshape(len(w), p * p)
        first = self.tracks.first
        slopes, bends = np.add.reduceat(slope, first), np.add.reduceat(bend, first)
        total = self.by_group(bends).reshape(self.count, p, p)
        return total, self.by_group(slopes), slopes

    def _finished(self, terms: Terms, here: FloatArray) -> Fit:
        """Covariance by blocks at the optimum."""
        residual = self.residual(terms, here)
        p = here.shape[1]
        if p == 0:
            empty = np.zeros((self.count, 0, 0))
            return Fit(terms=terms, coordinates=here, covariance=empty, residual=residual)
        jacobian = self.jacobian(terms, here, residual)
        curvature, _, slopes = self._normal(residual, jacobian)
        return Fit(
            terms=terms,
            coordinates=here,
            covariance=inverted(curvature).sandwich(self._meat(slopes)),
            residual=residual,
        )

    def _meat(self, slopes: FloatArray) -> FloatArray:
        """(groups, p, p) variance of the gradient, from whole blocks."""
        block = self.tracks.block
        blocks = int(block.max()) + 1
        p = slopes.shape[1]
        total = np.column_stack([np.bincount(block, slopes[:, k], blocks) for k in range(p)])
        begin = np.searchsorted(block, np.arange(blocks))
        group = self.window_group[begin]
        outer = (total[:, :, None] * total[:, None, :]).reshape(blocks, p * p)
        summed = np.column_stack(
            [np.bincount(group, outer[:, k], self.count) for k in range(p * p)]
        )
        number = np.bincount(group, minlength=self.count)
        small = number / np.maximum(number - p, 1)
        return np.asarray((summed * small[:, None]).reshape(self.count, p, p))


def _solve(curvature: FloatArray, gradient: FloatArray, damping: FloatArray) -> FloatArray:
    """(groups, p) damped Newton steps."""
    p = curvature.shape[1]
    diagonal = np.einsum("gpp->gp", curvature)
    damped = curvature + damping[:, None, None] * diagonal[:, :, None] * np.eye(p)
    return inverted(damped).step(gradient)

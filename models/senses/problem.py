"""Robust fits of causes to readings: terms of the whole swarm and of single robots together.

A hypothesis is a tuple of shared or private terms. Errors are Student-t. Held-out deviances come
from the optimum's own curvature, each fold of blocks left out in turn moving it by one Newton step,
and covariances from whole blocks, as for motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.cause import ALL
from realitygap.models.information import inverted
from realitygap.models.senses.cause import Belief, SenseCause
from realitygap.models.senses.predicted import noise, predict
from realitygap.models.senses.sight import NEAREST_LAMP, Bools, Sight, too_near

FOLDS = 5
DEGREES = 4.0
"""Of freedom of the errors: front infrared sensors have a fifth of gross outliers."""
ITERATIONS = 8
CONVERGED = 0.05
"""Deviance promised by a further step at which a fit has ended."""
STRETCH = 1.36
"""How far the optimum lies beyond one step with the weights as curvature, and its error beyond what
they give: the ratio of mean weight to mean curvature of such a deviance for normal errors."""
SWARM = -1
"""Scope of a term that all robots share."""


class Term(NamedTuple):
    """One variant of a cause, for one robot (its index) or for all (`SWARM`)."""

    cause: SenseCause
    variant: str = ALL
    robot: int = SWARM

    @property
    def key(self) -> str:
        """A name for tables, the same for every robot."""
        return f"{self.cause.name}/{self.variant}" if self.variant else self.cause.name

    @property
    def size(self) -> int:
        """Parameters."""
        return len(self.cause.parameters)


Terms = tuple[Term, ...]


@dataclass(frozen=True, eq=False)
class Column:
    """Change of the errors with one coordinate, at some rows."""

    rows: slice
    values: FloatArray
    """(those rows, 16) in noise."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """A fitted hypothesis."""

    terms: Terms
    coordinates: FloatArray
    """(p,)."""
    covariance: FloatArray
    """(p, p) by blocks; infinite for a coordinate that the data do not tell."""
    residual: FloatArray
    """(rows, 16) errors in noise; 0 where nothing is judged."""
    columns: list[Column]
    held_out: FloatArray
    """(blocks,) deviance of each block at the optimum of the other folds."""

    def part(self, term: Term) -> slice:
        """Where a term's coordinates are."""
        begin = sum(t.size for t in self.terms[: self.terms.index(term)])
        return slice(begin, begin + term.size)


class Problem:
    """Readings, what is believed of each robot before any term, and which readings count."""

    def __init__(
        self,
        sight: Sight,
        model: PointModel,
        base: Sequence[Belief],
        use: npt.NDArray[np.bool_],
    ) -> None:
        """Prepare; `use` (rows, 16) says which readings are judged."""
        self.sight, self.model, self.base, self.use = sight, model, list(base), use.copy()
        counts = predict(sight, model, self.base)
        self.noise = noise(sight, model, self.base, counts)
        self.blocks = int(sight.block.max()) + 1
        self.fold = (np.arange(self.blocks) * 7919 % 104729) % FOLDS  # neighbours in other folds

    def judge_anew(self, fit: Fit) -> None:
        """Take the noise from what a fit predicts, for most of infrared's is relative, and leave
        out light readings that its lamps are too near for, or that another robot may shade."""
        beliefs = self.beliefs(fit.terms, fit.coordinates)
        self.leave_out(beliefs)
        counts = predict(self.sight, self.model, beliefs)
        self.noise = noise(self.sight, self.model, beliefs, counts)

    def leave_out(self, beliefs: Sequence[Belief]) -> None:
        """Leave out light readings that say nothing of lamps elsewhere than in the model."""
        for mine, lamp in self.elsewhere(beliefs):
            poses = self.sight.poses[mine]
            shaded = self.sight.neighbours.only(mine).before_lamp(poses, lamp, self.model)
            self.use[mine, SENSORS:] &= ~(too_near(poses, lamp)[:, None] | shaded)

    def elsewhere(self, beliefs: Sequence[Belief]) -> list[tuple[Bools, tuple[float, float]]]:
        """Lamps believed to stand elsewhere than in the model, and (rows,) when they are lit."""
        found = []
        for x, y in {b.senses.second_lamp[:2] for b in beliefs if b.senses.second_lamp}:
            found.append((np.ones(len(self.sight.time), dtype=np.bool_), (x, y)))
        for dx, dy in {b.senses.lamp_shift for b in beliefs}:
            for index, lamp in enumerate(self.model.lamps):
                mine = self.sight.scenario == index
                if lamp is not None and np.hypot(dx, dy) > NEAREST_LAMP and mine.any():
                    found.append((mine, (lamp[0] + dx, lamp[1] + dy)))
        return found

    def beliefs(self, terms: Terms, coordinates: FloatArray) -> list[Belief]:
        """Each robot's belief with the terms."""
        result = list(self.base)
        begin = 0
        for term in terms:
            values = coordinates[begin : begin + term.size]
            begin += term.size
            for k in self.concerned(term):
                result[k] = term.cause.believed(result[k], values, term.variant)
        return result

    def concerned(self, term: Term) -> list[int]:
        """Indices of a term's robots."""
        return list(range(len(self.sight.robots))) if term.robot == SWARM else [term.robot]

    def rows(self, term: Term) -> slice:
        """Rows of a term's robots."""
        return slice(0, None) if term.robot == SWARM else self.sight.rows_of(term.robot)

    def residual(
        self, terms: Terms, coordinates: FloatArray, robots: Sequence[int] | None = None
    ) -> FloatArray:
        """(rows, 16) errors in noise; 0 for rows of robots not asked for."""
        counts = predict(self.sight, self.model, self.beliefs(terms, coordinates), robots)
        return np.where(self.use, (self.sight.read - counts) / self.noise, 0.0)

    def deviance(self, residual: FloatArray, rows: slice = slice(0, None)) -> FloatArray:
        """(blocks,) of readings at some rows."""
        each = (DEGREES + 1.0) * np.log1p(residual**2 / DEGREES).sum(axis=1)
        return np.asarray(np.bincount(self.sight.block[rows], each, self.blocks), dtype=float)

    def columns(
        self, terms: Terms, coordinates: FloatArray, residual: FloatArray, first: int = 0
    ) -> list[Column]:
        """Changes of the errors with every coordinate of the terms from the `first` on."""
        found = []
        begin = 0
        for index, term in enumerate(terms):
            for k, parameter in enumerate(term.cause.parameters):
                if index >= first:
                    there = coordinates.copy()
                    there[begin + k] += parameter.step
                    rows = self.rows(term)
                    moved = self.residual(terms, there, self.concerned(term))
                    found.append(Column(rows, (moved[rows] - residual[rows]) / parameter.step))
            begin += term.size
        return found

    def fit(self, terms: Terms, start: FloatArray) -> Fit:
        """Gauss-Newton from a start (p,)."""
        bounds = np.array([p.bounds for t in terms for p in t.cause.parameters]).reshape(-1, 2).T
        here = np.clip(start, *bounds) if len(start) else start
        residual = self.residual(terms, here)
        columns = self.columns(terms, here, residual)
        loss = float(self.deviance(residual).sum())
        damping = 1e-6
        for _ in range(ITERATIONS if len(here) else 0):
            slope, bend = self.normal(residual, columns)
            total = bend.sum(axis=0)
            damped = total + damping * np.diag(np.diag(total))
            step = inverted(damped).step(slope.sum(axis=0))
            if float(step @ slope.sum(axis=0)) < CONVERGED:
                break
            there = np.clip(here - step, *bounds)
            tried = self.residual(terms, there)
            lost = float(self.deviance(tried).sum())
            if lost < loss:
                here, residual, loss, damping = there, tried, lost, max(damping * 0.1, 1e-8)
                columns = self.columns(terms, here, residual)
            else:
                damping = max(damping * 30.0, 1e-3)
                if damping > 1e4:
                    break
        return self.finished(terms, here, residual, columns)

    def finished(
        self, terms: Terms, here: FloatArray, residual: FloatArray, columns: list[Column]
    ) -> Fit:
        """Covariance and held-out deviances at an optimum."""
        slope, bend = self.normal(residual, columns)
        centred = slope - slope.mean(axis=0)
        inverse = inverted(bend.sum(axis=0))
        return Fit(
            terms=terms,
            coordinates=here,
            covariance=STRETCH**2 * inverse.sandwich(centred.T @ centred),
            residual=residual,
            columns=columns,
            held_out=self.held_out(residual, columns, slope, bend),
        )

    def normal(self, residual: FloatArray, columns: list[Column]) -> tuple[FloatArray, FloatArray]:
        """Gradient (blocks, p) and curvature (blocks, p, p) of half the deviance."""
        p = len(columns)
        slope, bend = np.zeros((self.blocks, p)), np.zeros((self.blocks, p, p))
        n = len(residual)
        span = spanned(columns, n)
        used, left = self.use[span], residual[span]
        weight = np.where(used, (DEGREES + 1.0) / (DEGREES + left**2), 0.0)
        for i, one in enumerate(columns):
            begin, end, _ = one.rows.indices(n)
            pull = weight[begin - span.start : end - span.start] * one.values
            block = self.sight.block[begin:end]
            each = (pull * residual[begin:end]).sum(axis=1)
            slope[:, i] = np.bincount(block, each, self.blocks)
            for j, other in enumerate(columns[: i + 1]):
                b, e, _ = other.rows.indices(n)
                low, high = max(begin, b), min(end, e)
                if low >= high:
                    continue
                both = pull[low - begin : high - begin] * other.values[low - b : high - b]
                summed = np.bincount(self.sight.block[low:high], both.sum(axis=1), self.blocks)
                bend[:, i, j] = bend[:, j, i] = summed
        return slope, bend

    def held_out(
        self, residual: FloatArray, columns: list[Column], slope: FloatArray, bend: FloatArray
    ) -> FloatArray:
        """(blocks,) deviance with each fold left out of the fit."""
        if not columns:
            return self.deviance(residual)
        moved = self.moved(residual, columns, self.left_out(slope, bend), slice(0, len(residual)))
        return self.deviance(moved)

    def moved(
        self, residual: FloatArray, columns: list[Column], steps: FloatArray, rows: slice
    ) -> FloatArray:
        """(those rows, 16) errors after (folds, p) steps, each row's that of its fold."""
        moved = residual[rows].copy()
        row_fold = self.fold[self.sight.block[rows]]
        for i, one in enumerate(columns):
            begin, end, _ = one.rows.indices(len(residual))
            mine = slice(begin - rows.start, end - rows.start)
            moved[mine] += one.values * steps[row_fold[mine], i, None]
        return np.where(self.use[rows], moved, 0.0)

    def left_out(self, slope: FloatArray, bend: FloatArray) -> FloatArray:
        """(folds, p) by how much the optimum moves when a fold is left out."""
        total, pull = bend.sum(axis=0), slope.sum(axis=0)
        out = [self.fold == k for k in range(FOLDS)]
        rest = np.array([total - bend[one].sum(axis=0) for one in out])
        left = np.array([pull - slope[one].sum(axis=0) for one in out])
        return -inverted(rest).step(left)


def spanned(columns: Sequence[Column], number: int) -> slice:
    """Rows, of so many, from the first to the last that any column has."""
    ends = [one.rows.indices(number)[:2] for one in columns]
    return slice(min((b for b, _ in ends), default=0), max((e for _, e in ends), default=0))

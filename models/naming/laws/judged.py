"""What a law takes off blocks of a robot that it was not fitted to, health integrated out.

White errors are those of the engine of naming, with its noise, its weights and its folds of blocks.
Beside a law stand a robot's healthy differences, with what is believed of them, and the causes that
were named, free.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.robot import Robot
from realitygap.models.naming.engine.fitter import FOLDS
from realitygap.models.naming.engine.marginal import EMPTY, Prior

LITTLE = 1e-3
"""Of a column's information, what must be left of it beside everything else. No rule: below it, it
is something else."""


class Sums(NamedTuple):
    """Products of columns by fold."""

    base: FloatArray
    """(folds, q, l) with what stands beside."""
    own: FloatArray
    """(folds, q, q) with one another where they are tried together, else (folds, q) squares."""
    slope: FloatArray
    """(folds, q) with the errors."""


class Judgement(NamedTuple):
    """Columns of one robot, fitted together."""

    gain: FloatArray
    """(folds,) deviance that they take off each when fitted to the others."""
    information: FloatArray
    """(q, q) of all, everything else integrated out."""
    slope: FloatArray
    """(q,)."""

    @property
    def value(self) -> FloatArray:
        """(q,) coefficients."""
        return np.asarray(np.linalg.lstsq(self.information, self.slope, rcond=None)[0])

    @property
    def deviance(self) -> float:
        """Taken off all blocks."""
        return float(self.slope @ self.value)


class Panel:
    """One robot's white errors, and what stands beside any law."""

    def __init__(self, robot: Robot, prior: Prior, beside: Sequence[FloatArray] = ()) -> None:
        """Prepare.

        Args:
            robot: At its motion.
            prior: Over its columns.
            beside: (rows, q) white columns that are free.
        """
        self.robot, self._beside = robot, list(beside)
        fold = np.repeat((robot.block % FOLDS)[robot.tracks.window], 3)
        self._order = np.argsort(fold, kind="stable")
        self._edge = np.searchsorted(fold[self._order], np.arange(FOLDS + 1))
        free = np.concatenate([np.zeros((len(fold), 0)), *beside], axis=1)
        self.base = np.hstack([robot.columns[:, prior.at], free])
        self.errors = robot.own_errors
        covariance = np.zeros((self.base.shape[1],) * 2)
        known = len(prior.at)
        covariance[:known, :known] = prior.root @ prior.root.T
        size_of = (self.base[:, known:] ** 2).sum(axis=0)
        covariance[range(known, len(covariance)), range(known, len(covariance))] = 1e6 / np.maximum(
            size_of, EMPTY
        )
        mean = np.concatenate([prior.mean, np.zeros(free.shape[1])])
        self._prepare(covariance, mean)

    def _prepare(self, covariance: FloatArray, mean: FloatArray) -> None:
        base, errors = self.base, self.errors - self.base @ mean
        self.left = errors
        gram = np.stack([base[self._rows(f)].T @ base[self._rows(f)] for f in range(FOLDS)])
        pull = np.stack([base[self._rows(f)].T @ errors[self._rows(f)] for f in range(FOLDS)])
        self._gram, self._pull = gram, pull
        some = np.sqrt(np.maximum(np.diag(covariance), 1e-30))
        scaled = covariance / some[:, None] / some
        root = np.linalg.cholesky(scaled + 1e-9 * np.eye(len(some))) * some[:, None]

        def inverse(of: FloatArray) -> FloatArray:
            inner = np.linalg.inv(np.eye(len(root)) + root.T @ of @ root)
            return np.asarray(root @ inner @ root.T)

        self._without = [inverse(gram.sum(axis=0) - gram[f]) for f in range(FOLDS)]
        self._whole = inverse(gram.sum(axis=0))

    def _rows(self, fold: int) -> np.ndarray:
        return self._order[self._edge[fold] : self._edge[fold + 1]]

    def sums(self, columns: FloatArray, *, together: bool) -> Sums:
        """Of (rows, q) white columns; `together`: they are tried at once, not one by one."""
        base, own, slope = [], [], []
        for f in range(FOLDS):
            rows = self._rows(f)
            mine = columns[rows]
            base.append(mine.T @ self.base[rows])
            own.append(mine.T @ mine if together else (mine**2).sum(axis=0))
            slope.append(mine.T @ self.left[rows])
        return Sums(np.stack(base), np.stack(own), np.stack(slope))

    def gains(self, columns: FloatArray) -> FloatArray:
        """(folds, laws) deviance that laws take off folds that they were not fitted to, each alone.

        Args:
            columns: (rows, p, laws) white, of one or two for each law.
        """
        flat = columns.reshape(len(columns), -1)
        many = columns.shape[1:]
        sums = self.sums(flat, together=False)
        own = np.stack([_products(columns[self._rows(f)]) for f in range(FOLDS)])
        base = sums.base.reshape(FOLDS, *many, -1)
        slope = sums.slope.reshape(FOLDS, *many)
        found = np.zeros((FOLDS, many[1]))
        for f in range(FOLDS):
            a = self._without[f]
            before = a @ (self._pull.sum(axis=0) - self._pull[f])
            side = base.sum(axis=0) - base[f]
            moved = side @ a
            width = own.sum(axis=0) - own[f] - _inner(moved, side)
            pull = slope.sum(axis=0) - slope[f] - side @ before
            dose = _small(width, own.sum(axis=0), pull)
            # left on the fold: y - B b, of which a law changes c - B A side
            gradient = slope[f] - base[f] @ before
            gradient -= moved @ (self._pull[f] - self._gram[f] @ before)
            cross = _inner(base[f], moved)
            square = own[f] - cross - np.swapaxes(cross, 0, 1)
            square += _inner(moved @ self._gram[f], moved)
            found[f] = 2.0 * (dose * gradient).sum(axis=0)
            found[f] -= np.einsum("ic,ijc,jc->c", dose, square, dose)
        return found

    def told(self, sums: Sums, ridge: FloatArray | None = None) -> Judgement:
        """Of columns tried together.

        Args:
            sums: Of them.
            ridge: (q,) information that each has beforehand; None: none.
        """
        extra = np.zeros(sums.slope.shape[1]) if ridge is None else ridge
        gain = np.zeros(FOLDS)
        for f in range(FOLDS):
            a = self._without[f]
            before = a @ (self._pull.sum(axis=0) - self._pull[f])
            width, pull, moved = self._left(sums, a, before, f)
            dose = _solved(width + np.diag(extra), pull)
            gradient = sums.slope[f] - sums.base[f] @ before
            gradient -= moved @ (self._pull[f] - self._gram[f] @ before)
            cross = sums.base[f] @ moved.T
            square = sums.own[f] - cross - cross.T + moved @ self._gram[f] @ moved.T
            gain[f] = 2.0 * dose @ gradient - dose @ square @ dose
        before = self._whole @ self._pull.sum(axis=0)
        width, pull, _ = self._left(sums, self._whole, before, None)
        return Judgement(gain, width + np.diag(extra), pull)

    def _left(
        self, sums: Sums, a: FloatArray, before: FloatArray, fold: int | None
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Information and slope of columns beside the others, one fold left out."""
        side, own, pull = (part.sum(axis=0) for part in sums)
        if fold is not None:
            side, own, pull = side - sums.base[fold], own - sums.own[fold], pull - sums.slope[fold]
        moved = side @ a
        return own - moved @ side.T, pull - side @ before, moved

    def scores(self, columns: FloatArray, law: FloatArray) -> FloatArray:
        """(blocks, q) of (rows, q) columns, everything else free, beside a law's (rows,) share."""
        clear = columns - self.base @ (self._whole @ (self.base.T @ columns))
        rest = self.left - law
        rest = rest - self.base @ (self._whole @ (self.base.T @ rest))
        block = np.unique(self.robot.block, return_inverse=True)[1]
        windows = (self.robot.by_window(column * rest) for column in clear.T)
        return np.column_stack([np.bincount(block, one) for one in windows])


def _solved(width: FloatArray, pull: FloatArray) -> FloatArray:
    scale = np.sqrt(np.maximum(np.diag(width), EMPTY))
    inner = np.linalg.pinv(width / scale[:, None] / scale, rcond=LITTLE**2, hermitian=True)
    return np.asarray(inner @ (pull / scale) / scale)


def _products(columns: FloatArray) -> FloatArray:
    """(p, p, laws) of (rows, p, laws) columns."""
    return np.asarray(np.einsum("ric,rjc->ijc", columns, columns))


def _inner(one: FloatArray, other: FloatArray) -> FloatArray:
    """(p, p, laws) of (p, laws, l)."""
    return np.asarray(np.einsum("icl,jcl->ijc", one, other))


def _small(width: FloatArray, own: FloatArray, pull: FloatArray) -> FloatArray:
    """(p, laws) coefficients of one or two columns; 0 where nothing is left of them."""
    least = LITTLE * np.einsum("iic->ic", own) + EMPTY
    first = width[0, 0]
    if len(pull) == 1:
        clear = first > least[0]
        return np.where(clear, pull / np.where(clear, first, 1.0), 0.0)
    second, cross = width[1, 1], width[0, 1]
    det = first * second - cross**2
    clear = (first > least[0]) & (second > least[1]) & (det > LITTLE * first * second)
    some = np.where(clear, det, 1.0)
    both = np.stack([second * pull[0] - cross * pull[1], first * pull[1] - cross * pull[0]])
    return np.where(clear, both / some, 0.0)

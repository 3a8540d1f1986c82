"""The noise of pose windows, learned from the log itself: what every window has of its own.

Rows have Student-t errors of a scale per robot and axis. Beside them each window has its own place
and heading (free) and a little of speed, bend, turn rate, sideways motion, clock and lag of its
own, with variances that are those of the log; windows that differ more than others count less.
Variances and weights come by expectation-maximisation with every column free, so that what a cause
explains is not taken for noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.columns import FREE, Columns
from realitygap.models.naming.channels.motion.tracks import Rows
from realitygap.models.naming.rules import Rules

ROUNDS = 6
"""Of expectation-maximisation. No rule, as all numbers here: where iterations begin and end.
Variances of windows that have something of their own are then within a few per cent; where they
have nothing they still fall, far below the rows' noise."""
RIDGE = 10.0
"""Information that every column is taken to have beforehand, columns scaled to rms 1 noise: as good
as none, and enough where a column is empty."""
BEGIN = 0.3
"""rms noise: window effects begin there. Our choice, above what any log at hand ends at."""
WIDE = 1e8
"""Variance, of columns scaled to rms 1 noise, that is as good as none at all."""

LEAST_OWN = 0.1
"""Of a row's variance, least that is taken not to have been fitted away."""
NARROW = 4
"""Columns up to which all windows are summed at once, faster than one after the other."""


class Cut(Protocol):
    """How rows lie in windows."""

    @property
    def first(self) -> Rows:
        """(windows,) where each window begins."""

    @property
    def window(self) -> Rows:
        """(n,) window of each row, in order."""


@dataclass(frozen=True, eq=False)
class Noise:
    """Of the windows of one robot."""

    weight: FloatArray
    """(n, axes) of rows, their scale included."""
    window: FloatArray
    """(windows,) weights."""
    spread: FloatArray
    """(q,) standard deviation of the window effects, in units of their columns."""
    left: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    """(n, axes) squares of what the rows' errors are beside every column and effect."""


class WindowRows:
    """Rows of windows, their axes side by side: (n * axes, ...)."""

    def __init__(self, cut: Cut, axes: int) -> None:
        self._of = np.repeat(cut.window, axes)
        self._first = np.asarray(cut.first) * axes
        ends = [*self._first[1:].tolist(), len(self._of)]
        self._each = [slice(a, b) for a, b in zip(self._first.tolist(), ends, strict=True)]

    def products(self, rows: FloatArray, others: FloatArray) -> FloatArray:
        """(windows, p, k) of (rows, p) and (rows, k), each window's by itself."""
        if others.shape[1] <= NARROW:
            return np.add.reduceat(rows[:, :, None] * others[:, None, :], self._first, axis=0)
        found = np.empty((len(self._each), rows.shape[1], others.shape[1]))
        for k, own in enumerate(self._each):
            np.matmul(rows[own].T, others[own], out=found[k])
        return found

    def applied(self, rows: FloatArray, each: FloatArray) -> FloatArray:
        """(rows, k) of (rows, p) with what every window has, (windows, p, k)."""
        if each.shape[2] <= NARROW:
            return np.asarray((rows[:, :, None] * each[self._of]).sum(axis=1))
        found = np.empty((len(rows), each.shape[2]))
        for own, one in zip(self._each, each, strict=True):
            np.matmul(rows[own], one, out=found[own])
        return found

    def spread(self, each: FloatArray) -> FloatArray:
        """(rows, ...) of what every window has."""
        return each[self._of]


class Whitener:
    """Turns rows into independent ones of unit variance, window by window."""

    def __init__(self, cut: Cut, windows: FloatArray, noise: Noise, *, free: int = FREE) -> None:
        self._windows = WindowRows(cut, windows.shape[1])
        self._root = np.sqrt(noise.weight).reshape(-1, 1)
        z = windows.reshape(len(self._root), -1) * noise.spread * self._root
        z[:, free:] /= self._windows.spread(np.sqrt(noise.window))[:, None]
        size, turn = np.linalg.eigh(self._windows.products(z, z))
        size = np.maximum(size, 0.0)
        some = size > 1e-8
        shrink = np.where(some, (1.0 - 1.0 / np.sqrt(1.0 + size)) / np.where(some, size, 1.0), 0.5)
        self._seen = self._windows.applied(z, turn)
        self._shrunk = self._seen * self._windows.spread(shrink)

    def __call__(self, rows: FloatArray) -> FloatArray:
        """(n * axes, k) white ones of (n, axes, k)."""
        white = rows.reshape(len(self._root), -1) * self._root
        white -= self._windows.applied(self._shrunk, self._windows.products(self._seen, white))
        return np.asarray(white)


class _Expected(NamedTuple):
    """Of one robot, given what is believed of the noise."""

    square: FloatArray
    """(windows, q) of the window effects, in units of rms 1."""
    rows: FloatArray
    """(n, axes) squared errors of the rows."""


class _Robot:
    """One robot's rows, their axes side by side: what is fitted, the errors, the window effects."""

    def __init__(
        self,
        cut: Cut,
        made: Columns,
        size: FloatArray,
        unit: FloatArray,
        free: int,
        ridge: float,
        restricted: bool,
    ) -> None:
        self.windows, self.free, self.ridge = WindowRows(cut, made.errors.shape[1]), free, ridge
        self.restricted = restricted
        rows, self.many = made.errors.size, len(made.linear)
        self.rows = np.empty((rows, self.many + 1 + len(size)))
        x, y, z = np.split(self.rows, [self.many, self.many + 1], axis=1)
        np.divide(made.values[:, :, made.linear].reshape(rows, -1), unit, out=x)
        y[:] = made.errors.reshape(rows, 1)
        np.divide(made.windows.reshape(rows, -1), size, out=z)
        self.weight = np.ones_like(made.errors)
        self.left = made.errors
        self.window = np.ones(len(cut.first))

    def expected(self, spread: FloatArray) -> _Expected:
        k, q, windows = self.many, len(spread), self.windows
        x, y, z = np.split(self.rows, [k, k + 1], axis=1)
        prior = np.broadcast_to(spread, (len(self.window), q)).copy()
        prior[:, self.free :] /= np.sqrt(self.window)[:, None]
        root = np.sqrt(self.weight).reshape(-1, 1)
        scaled = self.rows * root
        seen = windows.products(scaled[:, k + 1 :], scaled) * prior[:, :, None]
        inner = np.linalg.inv(np.eye(q) + seen[:, :, k + 1 :] * prior[:, None, :])
        seen = seen[:, :, : k + 1]
        flat, bent = scaled[:, : k + 1], seen.reshape(-1, k + 1)
        found = flat.T @ flat - bent.T @ (inner @ seen).reshape(bent.shape)
        beta = np.linalg.solve(found[:k, :k] + self.ridge * np.eye(k), found[:k, k])
        left = y - (x @ beta)[:, None]
        own = inner @ (windows.products(scaled[:, k + 1 :], left * root) * prior[:, :, None])
        effect = prior * own[:, :, 0]
        square = effect**2 + np.einsum("wqq->wq", inner) * prior**2
        raw = z * windows.spread(prior)
        rest = left - windows.applied(raw, own)
        each = inner @ seen[:, :, :k] if self.restricted else seen[:, :, :0]
        both = windows.applied(raw, np.concatenate([inner, each], axis=2))
        doubt = (both[:, :q] * raw).sum(axis=1)
        errors = rest.reshape(self.weight.shape) ** 2
        if not self.restricted:
            return _Expected(square, errors + doubt.reshape(errors.shape))
        known = np.linalg.cholesky(np.linalg.inv(found[:k, :k] + self.ridge * np.eye(k)))
        clear = np.matmul(np.subtract(x, both[:, q:], out=both[:, q:]), known)
        doubt += np.einsum("nk,nk->n", clear, clear)
        sure = np.maximum(1.0 - self.weight * doubt.reshape(errors.shape), LEAST_OWN)
        return _Expected(square, errors / sure)


def learn(
    cuts: Sequence[Cut],
    made: Sequence[Columns],
    rules: Rules,
    *,
    free: int = FREE,
    least: float | None = None,
    ridge: float = RIDGE,
    restricted: bool = False,
) -> list[Noise]:
    """The noise of some robots' windows, with one set of variances for all.

    Args:
        cuts: Of one robot each.
        made: Their columns.
        rules: How long the tails of errors are, and how small they may be.
        free: How many window effects are free, the first ones.
        least: Of the noise that errors are told in, least that rows are taken to have; None: as the
            rules say.
        ridge: Information that columns have beforehand, as `RIDGE`.
        restricted: Whether what the fitted columns take off the rows is given back, as it must be
            where rows are few for their columns.
    """
    least = rules.least_scale if least is None else least
    rows = sum(one.errors.size for one in made)
    size = np.sqrt(sum((one.windows**2).sum(axis=(0, 1)) for one in made) / rows) + 1e-12
    unit = np.sqrt(sum((m.values[:, :, m.linear] ** 2).sum(axis=(0, 1)) for m in made) / rows)
    unit = np.where(unit > 0.0, unit, 1.0)
    robots = [
        _Robot(t, m, size, unit, free, ridge, restricted) for t, m in zip(cuts, made, strict=True)
    ]
    spread = np.full(len(size), BEGIN)
    spread[:free] = np.sqrt(WIDE)
    for _ in range(ROUNDS):
        total, count = np.zeros(len(size) - free), 0
        for one in robots:
            found = one.expected(spread)
            square = found.square[:, free:]
            many = square.shape[1]
            far = (square / spread[free:] ** 2).sum(axis=1)
            one.window = (rules.window_freedom + many) / (rules.window_freedom + far)
            total += (one.window[:, None] * square).sum(axis=0)
            count += len(square)
            one.weight, one.left = _weights(found.rows, least, rules.row_freedom), found.rows
        spread[free:] = np.sqrt(total / count) + 1e-6
    return [Noise(one.weight, one.window, spread / size, one.left) for one in robots]


def _weights(square: FloatArray, least: float, freedom: float) -> FloatArray:
    """(n, axes) weights of rows with Student-t errors of one scale per axis, squares alike."""
    scale = np.maximum(np.median(square, axis=0) / 0.455, least**2)
    for _ in range(4):
        t = (freedom + 1.0) / (freedom + square / scale)
        scale = np.maximum((t * square).mean(axis=0), least**2)
    return np.asarray((freedom + 1.0) / (freedom + square / scale) / scale)

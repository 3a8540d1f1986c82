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


class Padded:
    """Rows of windows side by side: (windows, longest * axes, ...)."""

    def __init__(self, cut: Cut) -> None:
        self._window = cut.window
        length = np.diff(np.append(cut.first, len(self._window)))
        self._longest = int(length.max(initial=1))
        self._at = np.arange(len(self._window)) - cut.first[self._window]
        self._windows = len(cut.first)

    def __call__(self, rows: FloatArray) -> FloatArray:
        """Of (n, axes, ...) rows; 0 beyond a window's end."""
        wide = np.zeros((self._windows, self._longest, *rows.shape[1:]))
        wide[self._window, self._at] = rows
        return wide.reshape(self._windows, self._longest * rows.shape[1], *rows.shape[2:])

    def back(self, wide: FloatArray) -> FloatArray:
        """(n, axes) rows of padded ones."""
        shaped = wide.reshape(self._windows, self._longest, -1)
        return np.asarray(shaped[self._window, self._at])


class Whitener:
    """Turns rows into independent ones of unit variance, window by window."""

    def __init__(self, cut: Cut, windows: FloatArray, noise: Noise, *, free: int = FREE) -> None:
        self._padded = Padded(cut)
        self._root = np.sqrt(self._padded(noise.weight))
        z = self._padded(windows) * noise.spread * self._root[:, :, None]
        z[:, :, free:] /= np.sqrt(noise.window)[:, None, None]
        size, turn = np.linalg.eigh(np.swapaxes(z, 1, 2) @ z)
        size = np.maximum(size, 0.0)
        some = size > 1e-8
        shrink = np.where(some, (1.0 - 1.0 / np.sqrt(1.0 + size)) / np.where(some, size, 1.0), 0.5)
        self._seen = z @ turn
        self._shrunk = self._seen * shrink[:, None, :]

    def __call__(self, rows: FloatArray) -> FloatArray:
        """(rows, k) white ones of (n, axes, k)."""
        wide = self._padded(rows) * self._root[:, :, None]
        white = wide - self._shrunk @ (np.swapaxes(self._seen, 1, 2) @ wide)
        return np.asarray(white.reshape(wide.shape[0] * wide.shape[1], rows.shape[2]))


class _Expected(NamedTuple):
    """Of one robot, given what is believed of the noise."""

    square: FloatArray
    """(windows, q) of the window effects, in units of rms 1."""
    rows: FloatArray
    """(n, axes) squared errors of the rows."""


class _Robot:
    """One robot's windows, padded once."""

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
        self.padded, self.free, self.ridge = Padded(cut), free, ridge
        self.restricted = restricted
        self.y = self.padded(made.errors)
        self.x = self.padded(made.values[:, :, made.linear] / unit)
        self.z = self.padded(made.windows / size)
        self.weight = np.ones_like(made.errors)
        self.left = made.errors
        self.window = np.ones(len(cut.first))

    def expected(self, spread: FloatArray) -> _Expected:
        root = np.sqrt(self.padded(self.weight))
        prior = np.broadcast_to(spread, (len(self.window), len(spread))).copy()
        prior[:, self.free :] /= np.sqrt(self.window)[:, None]
        z = self.z * root[:, :, None] * prior[:, None, :]
        turned = np.swapaxes(z, 1, 2)
        inner = np.linalg.inv(np.eye(len(spread)) + turned @ z)
        both = np.concatenate([self.x, self.y[:, :, None]], axis=2) * root[:, :, None]
        seen = turned @ both
        flat = both.reshape(-1, both.shape[2])
        bent = seen.reshape(-1, seen.shape[2])
        found = flat.T @ flat - bent.T @ (inner @ seen).reshape(bent.shape)
        k = self.x.shape[2]
        beta = np.linalg.solve(found[:k, :k] + self.ridge * np.eye(k), found[:k, k])
        left = self.y - self.x @ beta
        own = inner @ (turned @ (left * root)[:, :, None])
        effect = prior * own[:, :, 0]
        square = effect**2 + np.einsum("wqq->wq", inner) * prior**2
        raw = self.z * prior[:, None, :]
        rest = left - (raw @ own)[:, :, 0]
        unsure = ((raw @ inner) * raw).sum(axis=2)
        errors, doubt = self.padded.back(rest) ** 2, self.padded.back(unsure)
        if not self.restricted:
            return _Expected(square, errors + doubt)
        clear = self.x - raw @ (inner @ seen[:, :, :k])
        known = np.linalg.cholesky(np.linalg.inv(found[:k, :k] + self.ridge * np.eye(k)))
        doubt += self.padded.back(((clear @ known) ** 2).sum(axis=2))
        return _Expected(square, errors / np.maximum(1.0 - self.weight * doubt, LEAST_OWN))


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
    linear = [one.values[:, :, one.linear] for one in made]
    unit = np.sqrt(sum((one**2).sum(axis=(0, 1)) for one in linear) / rows)
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

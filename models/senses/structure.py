"""What in the readings follows which measured quantity: terms that no physics stands behind.

Whatever is wrong with sensors or lamps, if it follows something measured (where a sensor looks,
how much it reads, place, time, speed, neighbours), then readings are larger or smaller in step with
it: by a share of themselves or by counts. Each such term is fitted, beside what was named, to the
errors that are left, and its size is judged against what healthy robots show for the same term.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import SENSORS
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.information import inverted
from realitygap.models.senses.predicted import predict
from realitygap.models.senses.problem import DEGREES, STRETCH, Fit, Problem
from realitygap.models.senses.quantities import Key, of_readings, of_rows

KINDS = {"infrared": slice(0, SENSORS), "light": slice(SENSORS, 2 * SENSORS)}
"""Channels, and their columns."""

CHANGES = {"share": "by a share of what they read", "counts": "by counts"}
"""How readings may change."""

LEAST = 200
"""Readings of a robot, at least, that a term is looked for in."""
FEW_BLOCKS = 2.0
"""Blocks' worth of readings below which nobody can say how a term scatters from one to the next: a
robot that stood under the lamp has read light for a moment only. Our choice."""
ITERATIONS = 5
"""Of a robust fit of a few linear terms; five leave less than a hundredth of its gain."""
TINY = 1e-9


class Follow(NamedTuple):
    """One flexible term, per robot."""

    channel: str
    change: str
    quantity: str
    part: str
    """Which of a quantity's functions, such as its sine."""
    size: FloatArray
    """(robots,) share or counts per standard deviation of the quantity; NaN where nothing tells."""
    error: FloatArray
    """(robots,) by blocks."""
    gain: FloatArray
    """(robots,) squared error in noise that it takes off."""

    @property
    def group(self) -> str:
        """A name that the parts of one quantity share: sine and cosine, both axes of the floor."""
        words = [w for w in self.part.split() if w not in ("sin", "cos", "x", "y")]
        return "/".join((self.channel, self.change, self.quantity, *words))

    @property
    def key(self) -> str:
        """A name for tables."""
        return f"{self.channel}/{self.change}/{self.quantity}{self.part}"


class Structure:
    """Every flexible term beside the terms of a fit."""

    def __init__(self, problem: Problem, fit: Fit) -> None:
        counts = predict(problem.sight, problem.model, problem.beliefs(fit.terms, fit.coordinates))
        self._channels = {
            channel: _Channel(problem, fit, channel, counts[:, columns])
            for channel, columns in KINDS.items()
            if problem.use[:, columns].any()
        }
        self.follows = [one for c in self._channels.values() for one in c.follows()]
        """Their sizes, each robot by itself and each term alone."""

    def taken_off(self, parts: Sequence[Follow], robot: int | None) -> tuple[float, FloatArray]:
        """Deviance that the parts of one quantity take off together, and their sizes (parts,).

        Args:
            parts: Of one group.
            robot: Index; None: one size for all robots.
        """
        return self._channels[parts[0].channel].taken_off(parts, robot)


class _Channel:
    """Infrared or light, with weights and the columns of the terms already fitted."""

    def __init__(self, problem: Problem, fit: Fit, channel: str, counts: FloatArray) -> None:
        columns = KINDS[channel]
        self.problem, self.channel = problem, channel
        tables = problem.model.tables
        assert tables is not None
        self.signal = counts if channel == "infrared" else tables.ls_dark - counts
        use = problem.use[:, columns]
        self.residual = fit.residual[:, columns]
        weight = np.where(use, (DEGREES + 1.0) / (DEGREES + self.residual**2), 0.0)
        self.weight = weight
        self.noise = problem.noise[:, columns]
        self.fitted = _full(problem, fit, columns)
        block = problem.sight.block
        self.starts = np.flatnonzero(np.diff(block, prepend=-1))
        self.robot = problem.sight.robot[self.starts]
        self.count = len(problem.sight.robots)
        self.enough = np.bincount(problem.sight.robot, use.sum(axis=1), self.count) >= LEAST
        pulls = [(weight * k * self.residual).sum(axis=1) for k in self.fitted]
        self.own_slope = self._sums(np.array(pulls).reshape(-1, len(weight)).T)
        self.own_bend = np.zeros((len(self.starts), len(self.fitted), len(self.fitted)))
        for a, one in enumerate(self.fitted):
            for b, other in enumerate(self.fitted[: a + 1]):
                both = self._sums((weight * one * other).sum(axis=1))
                self.own_bend[:, a, b] = self.own_bend[:, b, a] = both
        self.own = [inverted(self.own_bend[self.robot == k].sum(axis=0)) for k in range(self.count)]
        sight, model = problem.sight, problem.model
        self.whole = of_rows(sight, model)
        self.single = of_readings(sight, model, self.signal, light=channel == "light")
        sign = -1.0 if channel == "infrared" else 1.0  # more light, fewer counts
        self.per = {"share": sign * self.signal / self.noise, "counts": sign / self.noise}

    def follows(self) -> list[Follow]:
        """Every term of this channel."""
        found = []
        for change in CHANGES:
            found += self._of_rows(change)
            found += [self._of_readings(change, key) for key in self.single]
        return [one for one in found if np.isfinite(one.size).any()]

    def taken_off(self, parts: Sequence[Follow], robot: int | None) -> tuple[float, FloatArray]:
        """As of `Structure`: a robust fit, with the fitted terms free to give way."""
        rows = slice(0, None) if robot is None else self.problem.sight.rows_of(robot)
        columns = np.stack(
            [self._column(one.change, (one.quantity, one.part))[rows] for one in parts]
            + [k[rows] for k in self.fitted]
        )
        use, start = self.problem.use[rows, KINDS[self.channel]], self.residual[rows]
        columns, start = columns[:, use], start[use]
        size = np.zeros(len(columns))
        for _ in range(ITERATIONS):
            left = start + size @ columns
            pull = columns * ((DEGREES + 1.0) / (DEGREES + left**2))
            size -= inverted(pull @ columns.T).step(pull @ left)
        left = start + size @ columns
        gain = np.log1p(start**2 / DEGREES).sum() - np.log1p(left**2 / DEGREES).sum()
        return float((DEGREES + 1.0) * gain), size[: len(parts)]

    def _column(self, change: str, key: Key) -> FloatArray:
        """(rows, 8) change of the errors per unit of a term."""
        per = self.per[change]
        if key in self.whole:
            values = self.whole[key]
            if key[0] != "always":
                values = self._standardised(values, (self.weight * per**2).sum(axis=1))
            return per * values[:, None]
        values = self.single[key]
        if key[0] != "sensor":
            values = self._standardised(values, self.weight * per**2)
        return per * values

    def _of_rows(self, change: str) -> list[Follow]:
        """Terms that all sensors of a robot share at a moment: sums over sensors come first."""
        per = self.per[change]
        pull = self.weight * per
        slope = (pull * self.residual).sum(axis=1)
        bend = (pull * per).sum(axis=1)
        cross = [(pull * k).sum(axis=1) for k in self.fitted]
        found = []
        for key, values in self.whole.items():
            q = values if key[0] == "always" else self._standardised(values, bend)
            sums = self._sums(np.stack([q * slope, q * q * bend, *(q * c for c in cross)], axis=1))
            found.append(self._follow(change, key, sums))
        return found

    def _of_readings(self, change: str, key: Key) -> Follow:
        """A term that each sensor has for itself."""
        column = self._column(change, key)
        pull = self.weight * column
        parts = [(pull * other).sum(axis=1) for other in (self.residual, column, *self.fitted)]
        return self._follow(change, key, self._sums(np.stack(parts, axis=1)))

    def _follow(self, change: str, key: Key, sums: FloatArray) -> Follow:
        """Size, error and gain out of (blocks, 2 + fitted) sums of slope, curvature and crosses."""
        slope, bend, cross = sums[:, 0], sums[:, 1], sums[:, 2:]
        size, error, gain = (np.full(self.count, np.nan) for _ in range(3))
        for k in np.flatnonzero(self.enough):
            mine = self.robot == k
            mix = self.own[k].step(cross[mine].sum(axis=0))
            left = slope[mine] - self.own_slope[mine] @ mix
            own = np.einsum("a,nab,b->n", mix, self.own_bend[mine], mix)
            curved = bend[mine] - 2.0 * cross[mine] @ mix + own
            total = float(curved.sum())
            if total < 1e-3 * float(bend[mine].sum()) or total < TINY:
                continue  # what was fitted can do the same
            if total**2 < FEW_BLOCKS * float((curved**2).sum()):
                continue
            size[k] = -left.sum() / total
            meat = float(((left + curved * size[k]) ** 2).sum())
            error[k] = STRETCH * np.sqrt(max(meat, total)) / total
            gain[k] = size[k] ** 2 * total
            size[k] *= STRETCH
        return Follow(self.channel, change, *key, size, error, gain)

    def _standardised(self, q: FloatArray, importance: FloatArray) -> FloatArray:
        """Mean 0 and standard deviation 1 for each robot, as far as the readings can tell."""
        sight = self.problem.sight
        first = sight.begin[:-1]

        def total(v: FloatArray) -> FloatArray:
            rows = v if v.ndim == 1 else v.sum(axis=1)
            return np.asarray(np.add.reduceat(rows, first))

        weight = np.maximum(total(importance), TINY)
        shape = (slice(None),) if q.ndim == 1 else (slice(None), None)
        centred = q - (total(importance * q) / weight)[sight.robot][shape]
        sd = np.sqrt(total(importance * centred**2) / weight)[sight.robot][shape]
        return np.asarray(np.where(sd > 1e-6, centred / np.maximum(sd, 1e-6), 0.0))

    def _sums(self, rows: FloatArray) -> FloatArray:
        """Over the rows of each block."""
        return np.asarray(np.add.reduceat(rows, self.starts, axis=0))


def _full(problem: Problem, fit: Fit, columns: slice) -> list[FloatArray]:
    """(rows, 8) changes of the errors with each fitted coordinate that this channel shows."""
    found = []
    for one in fit.columns:
        values = np.zeros((len(fit.residual), SENSORS))
        values[one.rows] = one.values[:, columns]
        if np.abs(values).max(initial=0.0) > TINY:
            found.append(values)
    return found

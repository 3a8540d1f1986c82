"""Fits of the causes of one scope by Gauss-Newton steps on the marginal deviance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.marginal import EMPTY, Scored, freed, integrated, shared
from realitygap.models.naming.engine.state import SWARM
from realitygap.models.naming.engine.subject import Subject
from realitygap.models.naming.engine.weighed import Weighed

FOLDS = 5
"""Parts into which a robot's blocks are dealt in turn. No rule, as all numbers here: limits and
tolerances of iterations."""
STEPS = 8
"""Gauss-Newton steps of a fit at most."""
ENDED = 0.05
"""Deviance that a further step must promise."""
HALVES = 4
"""Times a step is halved before it is given up."""


class Refined(NamedTuple):
    """Causes of one scope, fitted together."""

    coordinates: tuple[FloatArray, ...]
    covariance: FloatArray
    """(p, p) over all of them."""
    square: float
    """Deviance that is left."""


class Fitter:
    """Fits of the causes of one scope, everything else as it is."""

    def __init__(self, weighed: Weighed, scope: int) -> None:
        self.weighed, self.scope = weighed, scope
        self.state = weighed.state
        self.members = self.state.members(scope)
        self.flexible = np.array(
            [c for one in self.state.of(scope) if one.item.term is None for c in one.item.columns],
            dtype=np.int64,
        )
        self.priors = {
            k: weighed.prior_of(k) if scope == SWARM else weighed.prior_beside(k)
            for k in self.members
        }

    def fit(self, terms: Sequence[Term], start: Sequence[FloatArray]) -> Refined | None:
        """The causes at the values that fit best, from one start; None: no finite poses."""
        sizes = [len(t.cause.parameters) for t in terms]
        steps = np.array([p.step for t in terms for p in t.cause.parameters])
        smooth = np.array([t.cause.smooth for t in terms for _ in t.cause.parameters])
        bounds = [p.bounds for t in terms for p in t.cause.parameters]
        low, high = np.array(bounds).reshape(len(bounds), 2).T
        here = np.clip(np.concatenate([*start, np.zeros(0)]), low, high)
        if not len(terms):
            score = self._score(terms, sizes, here, np.zeros(0), smooth)
            return None if score is None else Refined((), np.zeros((0, 0)), score.square)
        score = self._score(terms, sizes, here, steps, smooth)
        if score is None:
            return None
        for _ in range(STEPS):
            inverse = _inverse(score.information)
            step = np.where(smooth, inverse @ score.slope, 0.0)
            if step @ score.slope < ENDED:
                break
            for _ in range(HALVES):
                there = np.clip(here + step, low, high)
                tried = self._score(terms, sizes, there, steps, smooth)
                if tried is not None and tried.square < score.square:
                    break
                step = step / 2.0
            else:
                break
            gained = score.square - tried.square
            here, score = there, tried
            if gained < ENDED:
                break
        return Refined(
            tuple(np.split(here, np.cumsum(sizes)[:-1])),
            _inverse(score.information),
            score.square,
        )

    def square(self, terms: Sequence[Term], coordinates: Sequence[FloatArray]) -> float:
        """Deviance with causes at given values."""
        sizes = [len(t.cause.parameters) for t in terms]
        here = np.concatenate([*coordinates, np.zeros(0)])
        none = np.zeros(len(here), dtype=bool)
        score = self._score(terms, sizes, here, np.ones(len(here)), none)
        return np.inf if score is None else score.square

    def scores(self, terms: Sequence[Term], coordinates: Sequence[FloatArray]) -> Scored:
        """Of every column, with causes at given values.

        Raises:
            Diverged: they give no finite poses.
        """
        here = np.concatenate([*coordinates, np.zeros(0)])
        sizes = [len(t.cause.parameters) for t in terms]
        found = []
        for k in self.members:
            robot = self.state.robots[k]
            errors = robot.errors(self._motion(k, terms, sizes, here))
            found.append(self._with(k, robot, np.empty((len(errors), 0)), errors))
        if self.scope != SWARM:
            return freed(found[0], self.flexible)
        spread = self.weighed.spread.copy()
        spread[self.weighed.free] = self.weighed.unfitted[self.weighed.free]
        return freed(shared(found, spread).total, self.flexible)

    def losses(self, terms: Sequence[Term], coordinates: Sequence[FloatArray]) -> FloatArray:
        """(windows,) squares of the white errors, member after member."""
        here = np.concatenate([*coordinates, np.zeros(0)])
        sizes = [len(t.cause.parameters) for t in terms]
        found = []
        for k in self.members:
            robot = self.state.robots[k]
            errors = robot.errors(self._motion(k, terms, sizes, here))
            found.append(robot.by_window(errors**2))
        return np.concatenate(found)

    def by_block(self, windows: FloatArray) -> FloatArray:
        """(blocks,) sums of (windows,) numbers, member after member; independent ones are left."""
        found, begin = [], 0
        for k in self.members:
            block = self.state.robots[k].block
            some = block >= 0
            mine = windows[begin : begin + len(block)]
            found.append(np.bincount(block[some], mine[some]))
            begin += len(block)
        return np.concatenate(found)

    def held_out(
        self, terms: Sequence[Term], coordinates: Sequence[FloatArray], which: int
    ) -> float:
        """Share of the squares that a cause takes off windows its size was not fitted to."""
        rest = [t for k, t in enumerate(terms) if k != which]
        others = [c for k, c in enumerate(coordinates) if k != which]
        here = np.concatenate([*others, np.zeros(0)])
        sizes = [len(t.cause.parameters) for t in rest]
        full = np.concatenate(list(coordinates))
        whole = [len(t.cause.parameters) for t in terms]
        folds = np.zeros((FOLDS, 3))
        for k in self.members:
            robot = self.state.robots[k]
            without = robot.errors(self._motion(k, rest, sizes, here))
            change = without - robot.errors(self._motion(k, terms, whole, full))
            fold = robot.block % FOLDS
            for i, (a, b) in enumerate(((without, without), (without, change), (change, change))):
                folds[:, i] += np.bincount(fold, robot.by_window(a * b), FOLDS)
        square, pull, own = folds.T
        dose = (pull.sum() - pull) / np.maximum(own.sum() - own, EMPTY)
        return float((2.0 * dose * pull - dose**2 * own).sum() / max(square.sum(), EMPTY))

    def changes(
        self, terms: Sequence[Term], coordinates: Sequence[FloatArray], term: Term
    ) -> tuple[FloatArray, FloatArray]:
        """(rows,) what a cause changes of the white errors, and (rows, p) per unit of the others'
        coordinates."""
        sizes = [len(t.cause.parameters) for t in terms]
        here = np.concatenate(list(coordinates))
        steps = [p.step for t in terms for p in t.cause.parameters]
        owner = [t for t in terms for _ in t.cause.parameters]
        rest = [t for t in terms if t != term]
        others = [c for t, c in zip(terms, coordinates, strict=True) if t != term]
        fewer = [len(t.cause.parameters) for t in rest]
        own, given = [], []
        for k in self.members:
            robot = self.state.robots[k]
            errors = robot.errors(self._motion(k, terms, sizes, here))
            less = np.concatenate([*others, np.zeros(0)])
            own.append(robot.errors(self._motion(k, rest, fewer, less)) - errors)
            columns = []
            for i, (step, of) in enumerate(zip(steps, owner, strict=True)):
                if of != term:
                    there = here.copy()
                    there[i] += step
                    moved_by = robot.errors(self._motion(k, terms, sizes, there)) - errors
                    columns.append(moved_by / step)
            given.append(np.array(columns).reshape(len(columns), len(errors)).T)
        return np.concatenate(own), np.concatenate(given)

    def beside(
        self,
        terms: Sequence[Term],
        coordinates: Sequence[FloatArray],
        columns: Sequence[FloatArray],
    ) -> Scored:
        """Of further columns, the causes fitted with them and everything else integrated out.

        Args:
            terms: The causes.
            coordinates: Where they are.
            columns: Per member, (rows, q) white columns.

        Raises:
            Diverged: the causes give no finite poses there.
        """
        sizes = [len(t.cause.parameters) for t in terms]
        steps = np.array([p.step for t in terms for p in t.cause.parameters])
        smooth = np.array([t.cause.smooth for t in terms for _ in t.cause.parameters])
        here = np.concatenate([*coordinates, np.zeros(0)])
        score = self._score(terms, sizes, here, steps, smooth, columns)
        if score is None:
            raise Diverged("the causes that were fitted")
        p = len(here)
        rest = freed(score, np.arange(p))
        return Scored(rest.information[p:, p:], rest.slope[p:], rest.square)

    def by_run(self, column: int) -> FloatArray:
        """(rows, runs) a white column in each run alone."""
        parts = [self.state.robots[k].by_run(column) for k in self.members]
        rows = sum(part[0].size for part in parts)
        each = sum(len(part) for part in parts)
        whole = np.zeros((rows, each))
        begin = at = 0
        for part in parts:
            for one in part:
                whole[begin : begin + one.size, at] = one
                at += 1
            begin += part[0].size
        return whole

    def _score(
        self,
        terms: Sequence[Term],
        sizes: Sequence[int],
        here: FloatArray,
        steps: FloatArray,
        smooth: FloatArray,
        further: Sequence[FloatArray] = (),
    ) -> Scored | None:
        """Of the causes' coordinates and further columns, all else integrated or fitted."""
        found = []
        p = len(here) + (further[0].shape[1] if further else 0)
        bends = [t.cause.bends for t in terms for _ in t.cause.parameters]
        for j, k in enumerate(self.members):
            robot = self.state.robots[k]
            try:
                errors = robot.errors(self._motion(k, terms, sizes, here))
                own = np.zeros((len(errors), p))
                if further:
                    own[:, len(here) :] = further[j]
                for i in np.flatnonzero(smooth):
                    ahead, back = here.copy(), here.copy()
                    ahead[i] += steps[i]
                    before, span = errors, steps[i]
                    if bends[i]:
                        back[i] -= steps[i]
                        before = robot.errors(self._motion(k, terms, sizes, back))
                        span = 2.0 * steps[i]
                    after = robot.errors(self._motion(k, terms, sizes, ahead))
                    own[:, i] = (before - after) / span
            except Diverged:
                return None
            found.append(self._with(k, robot, own, errors))
        if self.scope == SWARM:
            spread = np.concatenate([np.zeros(p), self.weighed.spread])
            spread[p + self.weighed.free] = 0.0  # the causes stand for their own columns here
            whole = shared(found, spread).total
        else:
            whole = found[0]
        whole = freed(whole, p + self.flexible)
        return Scored(whole.information[:p, :p], whole.slope[:p], whole.square)

    def _with(self, k: int, robot: Subject, own: FloatArray, errors: FloatArray) -> Scored:
        """A robot's score of some more columns before its own."""
        p, many = own.shape[1], len(robot.names)
        info = np.empty((p + many, p + many))
        info[:p, :p] = own.T @ own
        info[:p, p:] = robot.pulled(own)
        info[p:, :p] = info[:p, p:].T
        info[p:, p:] = robot.information
        slope = np.concatenate([own.T @ errors, robot.pulled(errors[:, None])[0]])
        prior = self.priors[k]
        return self._free(
            integrated(info, slope, float(errors @ errors), prior._replace(at=prior.at + p)), k, p
        )

    def _free(self, score: Scored, k: int, p: int) -> Scored:
        """Of a swarm's robot, what it has by itself fitted."""
        if self.scope != SWARM:
            return score
        return freed(score, p + self.weighed.fitted(k))

    def _motion(self, k: int, terms: Sequence[Term], sizes: Sequence[int], here: FloatArray) -> Any:
        parts = np.split(here, np.cumsum(sizes)[:-1]) if len(terms) else []
        motion = self.state.base[k]
        for scope in (SWARM, k):
            if scope == self.scope:
                for term, values in zip(terms, parts, strict=True):
                    motion = self.state.robots[k].applied(motion, term, values)
            else:
                for one in self.state.of(scope):
                    if one.item.term is not None:
                        robot = self.state.robots[k]
                        motion = robot.applied(motion, one.item.term, one.coordinates)
        return motion


def _inverse(information: FloatArray) -> FloatArray:
    scale = np.sqrt(np.maximum(np.diag(information), 1e-12))
    inner = np.linalg.pinv(information / scale[:, None] / scale, hermitian=True)
    return np.asarray(inner / scale[:, None] / scale)

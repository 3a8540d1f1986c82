"""A log's robots with what is believed to be the matter with them so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.hypothesis import Term
from realitygap.models.identify.tracks import Rows
from realitygap.models.naming.columns import Item
from realitygap.models.naming.health import Health
from realitygap.models.naming.marginal import (
    EMPTY,
    FLAT,
    Prior,
    Score,
    Shared,
    beside,
    freed,
    integrated,
    root_of,
    shared,
)
from realitygap.models.naming.subject import Subject

SWARM = -1
"""Scope of what all robots share; others are indices of robots."""
FOLDS = 5
"""Parts into which a robot's blocks are dealt in turn."""
STEPS = 8
"""Gauss-Newton steps of a fit at most."""
ENDED = 0.05
"""Deviance that a further step must promise."""
HALVES = 4
"""Times a step is halved before it is given up."""


class Kept(NamedTuple):
    """A cause with its fitted coordinates, or a flexible term."""

    item: Item
    coordinates: FloatArray
    """(p,); empty for a flexible term."""


class Refined(NamedTuple):
    """Causes of one scope, fitted together."""

    coordinates: tuple[FloatArray, ...]
    covariance: FloatArray
    """(p, p) over all of them."""
    square: float
    """Deviance that is left."""


@dataclass(frozen=True, eq=False)
class State:
    """Everything believed of a log."""

    tracks: Any
    """The log, cut as its channels ask: `Tracks` or `Sight`."""
    base: tuple[Any, ...]
    """(robots,) what is believed of healthy ones: `Motion` or `Belief`."""
    robots: tuple[Subject, ...]
    """With every cause kept."""
    health: Health
    kept: dict[int, tuple[Kept, ...]] = field(default_factory=dict)
    """By scope."""

    @property
    def items(self) -> tuple[Item, ...]:
        return self.robots[0].items

    def of(self, scope: int) -> tuple[Kept, ...]:
        return self.kept.get(scope, ())

    def members(self, scope: int) -> list[int]:
        """Robots of a scope."""
        return list(range(len(self.robots))) if scope == SWARM else [scope]

    def motion(self, k: int, own: dict[int, Sequence[Kept]]) -> Any:
        """What is believed of a robot with what is kept, some scopes replaced."""
        motion = self.base[k]
        for scope in (SWARM, k):
            for one in own.get(scope, self.of(scope)):
                if one.item.term is not None:
                    motion = self.robots[k].applied(motion, one.item.term, one.coordinates)
        return motion


class Weighed:
    """A state's scores: of every robot by itself, beside its swarm, and of the swarm."""

    def __init__(self, state: State) -> None:
        self.state = state
        names = state.robots[0].names
        self.prior, self._shared = state.health.on(names)
        self.alone = [self._alone(k) for k in range(len(state.robots))]
        self.free = self._columns(SWARM)
        self.spread = self._spread(self.free)
        self.common: Shared = shared(self.alone, self.spread)

    def score(self, scope: int) -> Score:
        """Of every column in a scope, what is kept there fitted too."""
        if scope == SWARM:
            return freed(self.common.total, self.free)
        return beside(self.alone[scope], self.common)

    def with_flexible(self, scope: int) -> Score:
        """Of every column in a scope, its causes fitted and its flexible terms not."""
        if scope != SWARM:
            return beside(self._alone(scope, flexible=False), self.common)
        free = self._columns(SWARM, flexible=False)
        return freed(shared(self.alone, self._spread(free)).total, free)

    def fitted(self, k: int) -> Rows:
        """Columns that a robot has free by itself."""
        return self._columns(k)

    def _columns(self, scope: int, *, flexible: bool = True) -> Rows:
        """Of what is kept in a scope."""
        kept = [one.item for one in self.state.of(scope) if one.item.dose is None]
        return np.array(
            [c for item in kept if flexible or item.term is not None for c in item.columns],
            dtype=np.int64,
        )

    @property
    def unfitted(self) -> FloatArray:
        """(k,) standard deviations of what swarms have in common."""
        return self._shared

    def _spread(self, free: Rows) -> FloatArray:
        """(k,) of what a swarm has in common, without bound where it is fitted."""
        spread = self._shared.copy()
        size = np.sum([np.diag(s.information)[free] for s in self.alone], axis=0)
        spread[free] = FLAT / np.sqrt(np.maximum(size, EMPTY))
        return spread

    def prior_of(self, k: int) -> Prior:
        """Of one robot, with what its causes feign beside."""
        return _feigning(self.prior, self.state, k)

    def prior_beside(self, k: int) -> Prior:
        """Of one robot, what its swarm has in common believed as the other robots say."""
        prior = self.prior_of(k)
        w = np.sum([s.information for j, s in enumerate(self.alone) if j != k], axis=0)
        t = np.sum([s.slope for j, s in enumerate(self.alone) if j != k], axis=0)
        if len(self.alone) < 2:
            w, t = np.zeros_like(self.alone[k].information), np.zeros(len(self.spread))
        inner = np.linalg.inv(np.eye(len(t)) + self.spread[:, None] * w * self.spread)
        shift = self.spread[:, None] * inner * self.spread
        at = prior.at
        own = prior.root @ prior.root.T + shift[np.ix_(at, at)]
        return Prior(at, prior.mean + (shift @ t)[at], root_of(own))

    def _alone(self, k: int, *, flexible: bool = True) -> Score:
        robot = self.state.robots[k]
        errors = robot.own_errors
        score = integrated(
            robot.information,
            robot.pulled(errors[:, None])[0],
            float(errors @ errors),
            self.prior_of(k),
        )
        return freed(score, self._columns(k, flexible=flexible))


def _feigning(prior: Prior, state: State, k: int) -> Prior:
    """A prior with what rough causes of a robot make other causes seem."""
    rough = [
        one.item.term.cause
        for scope in (SWARM, k)
        for one in state.of(scope)
        if one.item.term is not None and one.item.term.cause.feigns
    ]
    if not rough:
        return prior
    names = state.robots[k].names
    extra = np.zeros(len(prior.at))
    for cause in rough:
        for i, c in enumerate(prior.at):
            feigned = cause.feigns.get(names[c].partition(".")[0].partition("/")[0], 0.0)
            if "." in names[c]:
                extra[i] += feigned**2
    return prior._replace(root=root_of(prior.root @ prior.root.T + np.diag(extra)))


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

    def scores(self, terms: Sequence[Term], coordinates: Sequence[FloatArray]) -> Score:
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
        """(blocks,) sums of (windows,) numbers, member after member."""
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
    ) -> Score | None:
        """Of the causes' coordinates, everything else integrated or fitted."""
        found = []
        p = len(here)
        bends = [t.cause.bends for t in terms for _ in t.cause.parameters]
        for k in self.members:
            robot = self.state.robots[k]
            try:
                errors = robot.errors(self._motion(k, terms, sizes, here))
                own = np.zeros((len(errors), p))
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
        return Score(whole.information[:p, :p], whole.slope[:p], whole.square)

    def _with(self, k: int, robot: Subject, own: FloatArray, errors: FloatArray) -> Score:
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

    def _free(self, score: Score, k: int, p: int) -> Score:
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


def with_kept(state: State, scope: int, kept: Sequence[Kept]) -> State:
    """The state with other beliefs of one scope, its robots moved there."""
    changed = replace(state, kept={**state.kept, scope: tuple(kept)})
    members = set(state.members(scope))
    robots = []
    for k, robot in enumerate(state.robots):
        motion = changed.motion(k, {})
        there = k in members and motion is not robot.motion
        robots.append(robot.moved(motion, state.tracks) if there else robot)
    return replace(changed, robots=tuple(robots))

"""What a log says of every column in every scope, given what is believed so far."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.engine.marginal import (
    EMPTY,
    FLAT,
    Prior,
    Scored,
    Shared,
    beside,
    freed,
    integrated,
    root_of,
    shared,
)
from realitygap.models.naming.engine.state import SWARM, State


class Weighed:
    """A state's scores: of every robot by itself, beside its swarm, and of the swarm."""

    def __init__(self, state: State) -> None:
        self.state = state
        names = state.robots[0].names
        healthy, common = state.health.on(names, state.rules)
        self.prior = _wider(healthy, np.array([state.between.get(name, 0.0) for name in names]))
        recorded = np.array([state.unsure.get(name, 0.0) for name in names])
        self._shared: FloatArray = np.hypot(common, recorded)
        self.alone = [self._alone(k, self._columns(k)) for k in range(len(state.robots))]
        self.free = self._columns(SWARM)
        self.spread = self._spread(self.free)
        self.common: Shared = shared(self.alone, self.spread)

    def score(self, scope: int) -> Scored:
        """Of every column in a scope, what is kept there fitted too."""
        if scope == SWARM:
            return freed(self.common.total, self.free)
        return beside(self.alone[scope], self.common)

    def beside_some(self, k: int, robots: Sequence[int]) -> Scored:
        """Of every column of a robot, beside what it and some robots have in common."""
        members = sorted({k, *robots})
        common = shared([self.alone[j] for j in members], self.spread)
        return beside(self.alone[k], common)

    def with_flexible(self, scope: int) -> Scored:
        """Of every column in a scope, its causes fitted and its flexible terms not."""
        return self._with_free(scope, self._columns(scope, flexible=False))

    def information_of(self, scope: int, item: Item) -> FloatArray:
        """(p, p) on an item beside what is kept in a scope, whether or not it is kept itself."""
        at = list(item.columns)
        free = np.setdiff1d(self._columns(scope), at)
        return self._with_free(scope, free).information[np.ix_(at, at)]

    def _with_free(self, scope: int, free: Rows) -> Scored:
        if scope != SWARM:
            return beside(self._alone(scope, free), self.common)
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
        """Of one robot, what its swarm has in common believed as the other robots say.

        Also of what health does not know, as how a log was recorded: a cause and that are known as
        a sum alone.
        """
        prior = self.prior_of(k)
        w = np.sum([s.information for j, s in enumerate(self.alone) if j != k], axis=0)
        t = np.sum([s.slope for j, s in enumerate(self.alone) if j != k], axis=0)
        if len(self.alone) < 2:
            w, t = np.zeros_like(self.alone[k].information), np.zeros(len(self.spread))
        inner = np.linalg.inv(np.eye(len(t)) + self.spread[:, None] * w * self.spread)
        shift = self.spread[:, None] * inner * self.spread
        own, mean = shift.copy(), shift @ t
        own[np.ix_(prior.at, prior.at)] += prior.root @ prior.root.T
        mean[prior.at] += prior.mean
        at = np.union1d(prior.at, np.flatnonzero(self.spread))
        return Prior(at, mean[at], root_of(own[np.ix_(at, at)]))

    def _alone(self, k: int, free: Rows) -> Scored:
        robot = self.state.robots[k]
        errors = robot.own_errors
        score = integrated(
            robot.information,
            robot.pulled(errors[:, None])[0],
            float(errors @ errors),
            self.prior_of(k),
        )
        return freed(score, free)


def _wider(prior: Prior, between: FloatArray) -> Prior:
    """A prior with more spread, (k,) standard deviations by column, of robots."""
    if not between.any():
        return prior
    at = np.union1d(prior.at, np.flatnonzero(between))
    own, mean, old = np.diag(between[at] ** 2), np.zeros(len(at)), np.searchsorted(at, prior.at)
    own[np.ix_(old, old)] += prior.root @ prior.root.T
    mean[old] = prior.mean
    return Prior(at, mean, root_of(own))


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
            called = names[c]
            key = called.partition(".")[0].partition("/")[0] if "." in called else called
            extra[i] = np.hypot(extra[i], cause.feigns.get(key, 0.0))
    between = np.zeros(len(names))
    between[prior.at] = extra
    return _wider(prior, between)

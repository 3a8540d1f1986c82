"""A lamp that stands somewhere else altogether: a grid of places is tried, the best are refined.

No step from the null leads to such a lamp, and from a place some decimetres off the fit of all
readings with their own small noise ends in the next hollow. So the light of a few moments is
compared by its logarithm: how many times too bright or too dark it is, near a lamp as far from it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from realitygap.embedded_sim import SENSORS
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes.withheld import withheld
from realitygap.models.senses.cause import Belief
from realitygap.models.senses.causes import sense_causes
from realitygap.models.senses.predicted import predict
from realitygap.models.senses.problem import DEGREES, Problem, Term

MOMENTS = 2000
"""Rows whose light chooses among leaps; all of them judge the chosen one."""
ASTRAY = 2.0
"""Mean error of light, in noise, from which leaps are tried; a sound robot's is about 0.8."""
DIM = 10.0
"""counts of light, below which it differs by noise alone."""
ROUGHLY = 0.3
"""Error of the light's logarithm that a lamp which is a few centimetres off may leave."""
REFINED = 3
"""Leaps of each cause, the best, that are refined. Our choice: the nearest is among them."""
STEP = 0.06
"""m, or share of a lamp, by which the best leaps are first moved: half of what lies between two."""
NEAR = 0.005
"""The same, from where the fit of all readings finds the place; a lamp's own is no more exact."""


class Leap(NamedTuple):
    """A lamp that stands somewhere else altogether."""

    term: Term
    where: FloatArray
    """(p,) coordinates, as some moments' light tells them."""

    def believed(self, belief: Belief) -> Belief:
        """A belief with it."""
        return self.term.cause.believed(belief, self.where, self.term.variant)


def far_leap(problem: Problem) -> Leap | None:
    """The lamp that tells best what light was read; None where light is read so nearly as expected
    that a step from the null finds whatever there is."""
    if not _astray(problem):
        return None
    seen = _Glimpse(problem)
    best, least = None, seen.loss()
    for cause in sense_causes().values():
        if withheld(cause.name):
            continue
        term = Term(cause)
        tried = sorted(cause.leaps(), key=lambda leap: seen.loss(Leap(term, leap)))
        for start in tried[:REFINED]:
            leap, loss = seen.refined(Leap(term, start))
            if loss < least:
                best, least = leap, loss
    return best


def _astray(problem: Problem) -> bool:
    """Whether light is read quite otherwise than expected."""
    residual = problem.residual((), np.zeros(0))[:, SENSORS:]
    light = np.abs(residual[problem.use[:, SENSORS:]])
    return bool(light.size) and float(light.mean()) > ASTRAY


class _Glimpse:
    """Light read at some moments of all robots, and how far it is from what is believed."""

    def __init__(self, problem: Problem) -> None:
        rows = np.unique(np.linspace(0, len(problem.use) - 1, MOMENTS).astype(np.int64))
        assert problem.model.tables is not None
        self._dark = problem.model.tables.ls_dark
        self._model, self._base = problem.model, problem.base
        self._sight = problem.sight.only(rows)
        self._use = problem.use[rows, SENSORS:]
        self._read = self._level(self._sight.read[:, SENSORS:])

    def loss(self, leap: Leap | None = None) -> float:
        """Deviance of the light with a leap, or without any."""
        beliefs = self._base if leap is None else [leap.believed(b) for b in self._base]
        counts = predict(self._sight, self._model, beliefs)
        error = (self._read - self._level(counts[:, SENSORS:]))[self._use] / ROUGHLY
        return float(np.log1p(error**2 / DEGREES).sum())

    def refined(self, leap: Leap) -> tuple[Leap, float]:
        """The leap near one where the loss is least, and that loss."""

        def lost(where: FloatArray) -> float:
            return self.loss(leap._replace(where=where))

        where = leap.where
        simplex = np.vstack([where, where + STEP * np.eye(len(where))])
        found = minimize(
            lost,
            where,
            method="Nelder-Mead",
            options={"initial_simplex": simplex, "xatol": NEAR, "fatol": 1.0},
        )
        return leap._replace(where=np.asarray(found.x)), float(found.fun)

    def _level(self, counts: FloatArray) -> FloatArray:
        """Logarithm of the light that takes so many counts off the dark."""
        return np.asarray(np.log(np.maximum(self._dark - counts, 0.0) + DIM))

"""A lamp that stands somewhere else altogether: places on a grid are tried, the best are refined.

No step from the null leads to such a lamp, and from a place some decimetres off the fit of all
readings with their own small noise ends in the next hollow. So the light of a few moments is
compared by its logarithm: how many times too bright or too dark it is, near a lamp as far from it.
The places found are whole doses of their causes; the mixed model judges them like any others.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import minimize

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.naming.channels.senses.predicted import predict
from realitygap.models.naming.channels.senses.sight import Sight
from realitygap.models.naming.channels.senses.terms import Doses, applied, sense_terms
from realitygap.models.naming.engine.hypothesis import Term

MOMENTS = 1000
"""Rows whose light chooses among places; all of them judge what is chosen. Our choice.
No rule, as all numbers here: they say from where fits begin; the mixed model judges where these
end."""
DIM = 10.0
"""counts of light, below which it differs by noise alone."""
ROUGHLY = 0.3
"""Error of the light's logarithm that a lamp which is a few centimetres off may leave; light that
is off by less in the mean is within reach of a step from the null."""
DEGREES = 4.0
"""Of freedom of that error: some moments are shaded."""
REFINED = 3
"""Places of each cause, the best, that are refined. Our choice: the nearest is among them."""
STEP = 0.06
"""m, or share of a lamp, by which the best places are first moved: half of what lies between."""
BRIGHTNESS = "lamp_intensity"
"""To which steps from the null do lead."""
SURELY_ELSEWHERE = 100.0
"""Deviance of moments by which a lamp elsewhere must tell the light better than a dimmer one: ten
standard deviations, for the moments are not independent."""
NEAR = 0.005
"""The same, from where the fit of all readings finds the place; a lamp's own is no more exact."""


def far_lamps(sight: Sight, model: PointModel, believed: Sequence[Belief]) -> Doses:
    """Coordinates of lamps that tell the light better than the one believed in does, were it as
    bright as it seems, by term.

    Args:
        sight: Of all robots.
        model: With tables.
        believed: Of each robot.
    """
    seen = _Glimpse(sight, model, believed)
    doses: dict[Term, list[FloatArray]] = {}
    if not seen.astray:
        return doses
    dimmed = [
        seen.refined(term, np.zeros(1))[1]
        for term in sense_terms()
        if term.cause.name == BRIGHTNESS
    ]
    bar = min([seen.least, *dimmed]) - SURELY_ELSEWHERE
    for term in sense_terms():
        assert isinstance(term.cause, SenseCause)
        places = sorted(term.cause.leaps(), key=lambda place: seen.loss(term, place))
        refined = [seen.refined(term, place) for place in places[:REFINED]]
        better = [place for place, loss in refined if loss < bar]
        if better:
            doses[term] = better
    return doses


def elsewhere(
    sight: Sight, model: PointModel, believed: Sequence[Belief], doses: Doses
) -> tuple[Term, FloatArray] | None:
    """The one lamp of those found that tells the light best; None: none was found.

    Far from where light is read to come from, errors are no longer in proportion to a dose of it.

    Args:
        sight: Of all robots.
        model: With tables.
        believed: Of each robot.
        doses: By term, places that may be it.
    """
    seen = _Glimpse(sight, model, believed)
    found = [(seen.loss(term, place), term, place) for term in doses for place in doses[term]]
    _, term, place = min(found, key=lambda one: one[0], default=(0.0, None, np.zeros(0)))
    return None if term is None else (term, place)


class _Glimpse:
    """Light read at some moments of all robots, and how far it is from what is believed."""

    def __init__(self, sight: Sight, model: PointModel, believed: Sequence[Belief]) -> None:
        every = np.linspace(0, len(sight.time) - 1, min(MOMENTS, len(sight.time)))
        rows = np.unique(every.astype(np.int64))
        assert model.tables is not None
        self._dark = model.tables.ls_dark
        self._model, self._believed = model, believed
        self._sight = sight.only(rows)
        self._use = self._sight.free[:, SENSORS:]
        self._read = self._level(self._sight.read[:, SENSORS:])
        error = self._error(believed)
        self.astray = bool(error.size) and float(np.abs(error).mean()) > 1.0
        self.least = self._sum(error)

    def loss(self, term: Term, place: FloatArray) -> float:
        """Deviance of the light with a lamp."""
        return self._sum(self._error([applied(b, term, place) for b in self._believed]))

    def refined(self, term: Term, place: FloatArray) -> tuple[FloatArray, float]:
        """The place near one where the loss is least, and that loss."""

        def lost(there: FloatArray) -> float:
            return self.loss(term, there)

        simplex = np.vstack([place, place + STEP * np.eye(len(place))])
        found = minimize(
            lost,
            place,
            method="Nelder-Mead",
            options={"initial_simplex": simplex, "xatol": NEAR, "fatol": 1.0},
        )
        return np.asarray(found.x), float(found.fun)

    def _error(self, believed: Sequence[Belief]) -> FloatArray:
        counts = predict(self._sight, self._model, believed)
        return np.asarray((self._read - self._level(counts[:, SENSORS:]))[self._use] / ROUGHLY)

    def _sum(self, error: FloatArray) -> float:
        return float(np.log1p(error**2 / DEGREES).sum())

    def _level(self, counts: FloatArray) -> FloatArray:
        """Logarithm of the light that takes so many counts off the dark."""
        return np.asarray(np.log(np.maximum(self._dark - counts, 0.0) + DIM))

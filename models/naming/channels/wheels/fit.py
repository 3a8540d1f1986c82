"""Terms fitted to one robot's encoders, by replay in C."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.log.blocks import BLOCK_SECONDS, nth
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.motion.predict import coarse, wheel_errors
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.engine.hypothesis import Term, Terms

EVALUATIONS = 30
"""Most steps of one fit. No rule: it bounds work."""
SCALED = 20.0
"""Steps of a parameter that are one unit of the fit. No rule: of numerics."""
Coordinates = tuple[FloatArray, ...]
"""(p,) of each term."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WheelFit:
    """Terms fitted to one robot's wheels."""

    terms: Terms
    at: Coordinates
    loss: FloatArray
    """(n,) deviance of each row."""


class EncodedWheels:
    """One robot's encoders beside what motors should have made of its commands."""

    def __init__(self, tracks: Tracks, base: Motion) -> None:
        self.tracks, self.base, self.rules = tracks, base, tracks.rules
        off, self._rows = wheel_errors(tracks, [base])
        label = nth(tracks.t - tracks.t.min(), BLOCK_SECONDS)[self._rows]
        of_run = np.column_stack([tracks.row_segment[self._rows], label])
        self.block = np.unique(of_run, axis=0, return_inverse=True)[1].ravel()
        self.part = tracks.part[self._rows]
        self.judged = np.ones(len(off), dtype=bool)
        self._least = coarse(tracks.step)
        self.scale = max(float(np.sqrt(np.mean(off**2))), self._least)

    def of_part(self, part: int) -> EncodedWheels | None:
        """The same judged in one part of the log alone; None: there is nothing of it."""
        if not (self.part == part).any():
            return None
        one = copy(self)
        one.judged = self.part == part
        return one

    def motion(self, terms: Terms, at: Coordinates) -> Motion:
        """The motion with terms at coordinates."""
        motion = self.base
        for term, here in zip(terms, at, strict=True):
            motion = term.cause.applied(motion, here, term.variant)
        return motion

    def off(self, terms: Terms, at: Coordinates) -> FloatArray:
        """(n, 2) errors of the rows judged, in their scale."""
        return wheel_errors(self.tracks, [self.motion(terms, at)])[0][self.judged] / self.scale

    def _loss(self, squared: FloatArray) -> FloatArray:
        """Student's t of squared errors and its two derivatives, as `least_squares` asks."""
        freedom = self.rules.row_freedom
        below = 1.0 + squared / freedom
        slope = (freedom + 1.0) / freedom / below
        return np.array([(freedom + 1.0) * np.log(below), slope, -slope / (freedom * below)])

    def jacobian(self, terms: Terms, at: Coordinates) -> FloatArray:
        """(2 n, p) of the errors by the terms' coordinates; nought for a threshold, which jumps."""
        flat, columns = np.concatenate(at), []
        here = self.off(terms, at).ravel()
        parameters = [(p, term.cause.smooth) for term in terms for p in term.cause.parameters]
        for k, (p, smooth) in enumerate(parameters):
            if not smooth:
                columns.append(np.zeros(len(here)))
                continue
            step = -p.step if flat[k] + p.step > p.bounds[1] else p.step
            there = flat.copy()
            there[k] += step
            columns.append((self.off(terms, cut(terms, there)).ravel() - here) / step)
        return np.column_stack(columns)

    def _bounds(self, term: Term, k: int) -> tuple[float, float]:
        """Of a parameter, without the side on which nothing changes any more."""
        parameter = term.cause.parameters[k]
        low, high = parameter.bounds
        less = np.zeros(len(term.cause.parameters))
        less[k] = -parameter.step
        idle = np.isfinite(parameter.null) and self.motion((term,), (less,)) == self.base
        return (0.0 if idle else low), high

    def fit(self, terms: Terms, start: Coordinates) -> WheelFit:
        """The terms where the errors are least, from a start."""
        smooth = tuple(k for k, term in enumerate(terms) if term.cause.smooth)
        at = list(start)
        if smooth:
            free = tuple(terms[k] for k in smooth)
            fixed = [(terms[k], start[k]) for k in range(len(terms)) if k not in smooth]

            def whole(flat: FloatArray) -> tuple[Terms, Coordinates]:
                own = list(zip(free, cut(free, flat), strict=True)) + fixed
                return tuple(t for t, _ in own), tuple(c for _, c in own)

            parameters = [p for term in free for p in term.cause.parameters]
            low, high = np.array(
                [self._bounds(term, k) for term in free for k in range(len(term.cause.parameters))]
            ).T
            begin = np.clip(np.concatenate([start[k] for k in smooth]), low + 1e-9, high - 1e-9)

            def errors(flat: FloatArray) -> FloatArray:
                return self.off(*whole(flat)).ravel()

            def slopes(flat: FloatArray) -> FloatArray:
                return self.jacobian(*whole(flat))[:, : len(flat)]

            found = least_squares(
                errors,
                begin,
                jac=slopes,
                bounds=(low, high),
                loss=self._loss,  # type: ignore[arg-type]  # a union of callables in its stubs
                x_scale=SCALED * np.array([p.step for p in parameters]),
                max_nfev=EVALUATIONS,
            )
            for k, here in zip(smooth, cut(free, found.x), strict=True):
                at[k] = here
        loss = self.deviance(self.off(terms, tuple(at)))
        return WheelFit(terms=terms, at=tuple(at), loss=loss)

    def deviance(self, off: FloatArray) -> FloatArray:
        """(n,) of errors (n, 2)."""
        return np.asarray(self._loss(off**2)[0].sum(axis=1))

    def rescaled(self, fit: WheelFit) -> None:
        """Take the errors' scale from a fit, robustly."""
        off = self.off(fit.terms, fit.at) * self.scale
        self.scale = max(NORMAL * float(np.median(np.abs(off))), self._least)

    def clearly(self, lost: FloatArray) -> bool:
        """Whether a loss (n,) is clearly above zero over blocks."""
        each = np.bincount(self.block[self.judged], lost)
        error = float(np.sqrt(np.sum((each - each.mean()) ** 2)))
        return float(each.sum()) > max(self.rules.cause_gate, self.rules.errors * error)

    def covariance(self, fit: WheelFit) -> FloatArray:
        """(p, p) of the smooth coordinates, by blocks."""
        jacobian, off = self.jacobian(fit.terms, fit.at), self.off(fit.terms, fit.at).ravel()
        weight = self._loss(off**2)[1]
        stiff = jacobian.T @ (weight[:, None] * jacobian)
        block = np.repeat(self.block[self.judged], 2)
        slope = np.array([np.bincount(block, c) for c in (jacobian * (weight * off)[:, None]).T])
        inverse = np.linalg.pinv(stiff)
        number = slope.shape[1]
        return np.asarray(inverse @ (slope @ slope.T) @ inverse * number / max(number - 1, 1))


def cut(terms: Terms, flat: FloatArray) -> Coordinates:
    """Flat coordinates by term."""
    edge = np.cumsum([len(term.cause.parameters) for term in terms])[:-1]
    return tuple(np.split(flat, edge))

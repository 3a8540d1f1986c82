"""From fitted coordinates to physical values with intervals that a person can use."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.measure import strength, uncertainty

NOMINAL = 1.96
"""Standard deviations of a normal variable on each side of 95 %. No rule: of statistics."""
MOST_LOG = 700.0
"""Largest logarithm of a number that a computer holds. No rule."""


class Value(NamedTuple):
    """One parameter's value and its 95 % interval."""

    name: str
    value: float
    low: float
    high: float
    unit: str


def values(
    term: Term,
    coordinates: FloatArray,
    covariance: FloatArray,
    commands: FloatArray,
) -> tuple[Value, ...]:
    """A term's parameters with intervals.

    Those hold the spread of healthy robots: the part is what is bought or set, not what this one
    robot happens to show.

    Args:
        term: Fitted.
        coordinates: (p,), less what healthy robots get.
        covariance: (p, p), with the spread of healthy robots.
        commands: (rows, 2).
    """
    limits = any(not np.isfinite(p.null) for p in term.cause.parameters)
    error = uncertainty(term, coordinates[None], covariance[None])[0]
    half = NOMINAL * error
    if limits:
        deep = strength(term, coordinates[None], commands)[0]
        fastest = float(np.log(np.abs(commands).max(initial=1e-9)))
        return tuple(
            told(p, *(_exp(fastest - e + side) for side in (0.0, -h, h)))
            for p, e, h in zip(term.cause.parameters, deep, half, strict=True)
        )
    found = []
    for p, u, h in zip(term.cause.parameters, coordinates, half, strict=True):
        rough = np.hypot(p.doubt * abs(u), p.unsure)
        h = float(np.hypot(h, NOMINAL * rough))
        found.append(told(p, *(p.believed(float(v)) for v in (u, u - h, u + h))))
    return tuple(found)


def told(parameter: Parameter, value: float, low: float, high: float) -> Value:
    """A value and the ends of its interval, which may be infinite, kept within bounds."""
    p = parameter
    return Value(p.name, p.kept(value), p.kept(low), p.kept(high), p.unit)


def _exp(log: float) -> float:
    """Of any number, however large."""
    return float(np.exp(min(log, MOST_LOG)))

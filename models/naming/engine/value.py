"""From fitted coordinates to physical values with intervals that a person can use."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Parameter
from realitygap.models.naming.engine.hypothesis import Term

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
) -> tuple[Value, ...]:
    """A term's parameters with intervals.

    Those hold the spread of healthy robots: the part is what is bought or set, not what this one
    robot happens to show.

    Args:
        term: Fitted.
        coordinates: (p,), less what healthy robots get.
        covariance: (p, p), with the spread of healthy robots.
    """
    found = []
    half = NOMINAL * np.sqrt(np.maximum(np.diag(covariance), 0.0))
    for p, c, h in zip(term.cause.parameters, coordinates, half.tolist(), strict=True):
        u = float(np.clip(c, *p.bounds))
        if np.isfinite(p.null):
            h = float(np.hypot(h, NOMINAL * np.hypot(p.doubt * abs(u), p.unsure)))
            found.append(told(p, *(p.believed(v) for v in (u, u - h, u + h))))
        else:  # a limit: always positive
            found.append(told(p, *(u * _exp(side / u) for side in (0.0, -h, h))))
    return tuple(found)


def told(parameter: Parameter, value: float, low: float, high: float) -> Value:
    """A value and the ends of its interval, which may be infinite, kept within bounds."""
    p = parameter
    return Value(p.name, p.kept(value), p.kept(low), p.kept(high), p.unit)


def _exp(log: float) -> float:
    """Of any number, however large."""
    return float(np.exp(min(log, MOST_LOG)))

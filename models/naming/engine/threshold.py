"""A threshold that jumps: between neighbouring commanded speeds all its values are the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray

REACH = 12
"""Neighbouring commanded speeds looked at on each side of a threshold. No rule: it bounds work."""


class Bracket(NamedTuple):
    """Where a threshold lies that a log only shows between two commanded speeds."""

    best: float
    """Middle of the gap between neighbouring speeds that fits best."""
    mean: float
    """Over all gaps, each weighted by its width and by how well it fits."""
    low: float
    high: float
    """Ends of the gaps that are not clearly worse."""


def bracket(
    commands: FloatArray, here: float, deviance: Callable[[float], float], odds: float
) -> Bracket:
    """The gaps between commanded speeds that a threshold may lie in.

    Args:
        commands: (rows, 2) rad/s of the robots concerned.
        here: About where it lies.
        deviance: Of the log, by the threshold.
        odds: Deviance within which a gap remains possible: twice what 95 % of a smooth parameter
            asks for, because neighbouring speeds are few.
    """
    speed = np.unique(np.abs(commands))
    speed = speed[speed > 0.0]
    near = int(np.searchsorted(speed, here))
    chosen = speed[max(0, near - REACH) : near + REACH]
    edges = np.concatenate([[0.0 if near <= REACH else chosen[0]], chosen])
    middles = 0.5 * (edges[1:] + edges[:-1])
    loss = np.array([deviance(float(middle)) for middle in middles])
    possible = np.flatnonzero(loss < loss.min() + odds)
    weight = np.diff(edges) * np.exp(-2.0 * (loss - loss.min()) / odds)  # its end: two s.d.
    return Bracket(
        best=float(middles[np.argmin(loss)]),
        mean=float(np.average(middles, weights=weight)),
        low=float(edges[possible[0]]),
        high=float(edges[possible[-1] + 1]),
    )

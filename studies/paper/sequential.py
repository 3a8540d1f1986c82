"""How often a claim may be looked at: a group-sequential boundary from a spending function.

Runs come in batches. At every look a claim may be decided, so each look may spend a part of the
chance of a wrong verdict (Lan and DeMets 1983). The part spent grows with the square of the share
of runs that are there (Kim and DeMets 1987): little at first, when intervals of few runs are worst.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.integrate import trapezoid
from scipy.optimize import brentq
from scipy.stats import norm

from realitygap.studies.paper.tables import Array

MOST_RUNS = 60
"""Runs of a condition at which everything is spent; 12 hours of computing allow them."""
WRONG = 0.05
"""Chance of any wrong verdict in a family of claims; the customary figure."""
GRID = 400
"""Points of the integration over the paths that are still open; our choice: 1e-4 in a boundary."""
FARTHEST = 12.0
"""Standard errors beyond which nothing is sought; more than any look asks for."""


def looks(batch: int) -> tuple[int, ...]:
    """Runs of each condition at which claims are looked at."""
    return tuple(range(batch, max(batch, MOST_RUNS) + 1, batch))


def shares(batch: int) -> tuple[float, ...]:
    """Of the most runs, at each look."""
    return tuple(min(1.0, runs / MOST_RUNS) for runs in looks(batch))


def squared(share: float, chance: float) -> float:
    """What may be spent at a share of the runs (Kim and DeMets 1987, power 2)."""
    return chance * share**2


@lru_cache(maxsize=256)
def boundary(
    shares: tuple[float, ...], chance: float, spent: Callable[[float, float], float] = squared
) -> tuple[float, ...]:
    """Standard errors that an estimate must be away from a bound, at each look.

    Args:
        shares: Of all runs that are there at each look, rising, at most 1.
        chance: One-sided: of ever being wrong.
        spent: Of `chance`, up to a share.
    """
    bounds: list[float] = []
    paths, density = np.zeros(1), np.ones(1)  # of the sum of scores, where it is still open
    before = used = 0.0
    for share in shares:
        step, reach = np.sqrt(share - before), np.sqrt(share)
        left = spent(share, chance) - used
        bound = float(brentq(_excess, -FARTHEST, FARTHEST, (paths, density, reach, step, left)))
        bounds.append(bound)
        open_at = np.linspace(-FARTHEST * reach, bound * reach, GRID)
        arriving = norm.pdf((open_at[:, None] - paths) / step) / step
        density = np.array([_over(paths, density * row) for row in arriving])
        paths, before, used = open_at, share, used + left
    return tuple(bounds)


def _excess(
    bound: float, paths: Array, density: Array, reach: float, step: float, left: float
) -> float:
    """By how much the chance of crossing a bound now exceeds what is left for it."""
    return _over(paths, density * norm.sf((bound * reach - paths) / step)) - left


def _over(at: Array, values: Array) -> float:
    """The integral; of a single path, its value."""
    return float(values[0]) if len(at) == 1 else float(trapezoid(values, at))

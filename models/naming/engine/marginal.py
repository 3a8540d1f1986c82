"""The likelihood of one robot's errors with its healthy differences integrated out.

A robot's errors are y = X (m + a + u) + J c + noise: m what healthy robots are in the mean beyond
the reference's motion, a what its swarm has in common, u what it has of its own, both Gaussian; c
what is the matter. `docs/model.md` writes it out. Everything here is in terms of information
matrices I = X'V^-1 X and slopes s = X'V^-1 y.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows

FLAT = 1e6
"""Prior standard deviation, in standard errors of a column alone, that is as good as free.
No rule, as all numbers here: tolerances."""
EMPTY = 1e-9
"""Information below which a column says nothing."""


class Prior(NamedTuple):
    """What is believed of some columns' coefficients beforehand."""

    at: Rows
    """(l,) the columns; the others are not there unless something is the matter."""
    mean: FloatArray
    """(l,)."""
    root: FloatArray
    """(l, l) of the covariance: root @ root.T."""


class Scored(NamedTuple):
    """What is known of every column's coefficient if it is free: t = W c."""

    information: FloatArray
    """(k, k)."""
    slope: FloatArray
    """(k,)."""
    square: float
    """Deviance without any."""


def root_of(covariance: FloatArray) -> FloatArray:
    """A square root of a covariance that may be singular."""
    size, turn = np.linalg.eigh(covariance)
    return np.asarray(turn * np.sqrt(np.maximum(size, 0.0)))


def integrated(information: FloatArray, slope: FloatArray, square: float, prior: Prior) -> Scored:
    """The score of every column with those of the prior integrated out."""
    at, mean, root = prior
    side = information[:, at] @ root
    inner = np.linalg.inv(np.eye(root.shape[1]) + root.T @ side[at])
    left = slope - information[:, at] @ mean
    pulled = root.T @ left[at]
    return Scored(
        information - side @ inner @ side.T,
        left - side @ (inner @ pulled),
        float(
            square
            - 2.0 * mean @ slope[at]
            + mean @ information[np.ix_(at, at)] @ mean
            - pulled @ inner @ pulled
        ),
    )


def freed(score: Scored, columns: Rows) -> Scored:
    """The score of every column with some of them fitted."""
    if not len(columns):
        return score
    w, t, square = score
    own = w[np.ix_(columns, columns)]
    scale = np.sqrt(np.maximum(np.diag(own), EMPTY))
    inverse = np.linalg.pinv(own / scale[:, None] / scale, hermitian=True) / scale[:, None] / scale
    pull = inverse @ t[columns]
    side = w[:, columns]
    return Scored(w - side @ inverse @ side.T, t - side @ pull, float(square - t[columns] @ pull))


class Shared(NamedTuple):
    """What a swarm has in common, given its robots' scores."""

    total: Scored
    """Of the swarm, its common shift integrated out."""
    covariance: FloatArray
    """(k, k) of the common shift."""
    shift: FloatArray
    """(k,)."""


def shared(scores: list[Scored], spread: FloatArray) -> Shared:
    """The swarm's own score, and the shift that its robots have in common.

    Args:
        scores: Of its robots, who have independent differences.
        spread: (k,) standard deviations of the shift; 0 where there is none.
    """
    w = np.sum([one.information for one in scores], axis=0)
    t = np.sum([one.slope for one in scores], axis=0)
    inner = np.linalg.inv(np.eye(len(spread)) + spread[:, None] * w * spread)
    covariance = spread[:, None] * inner * spread
    pull = covariance @ t
    total = Scored(
        w - w @ covariance @ w, t - w @ pull, sum(one.square for one in scores) - float(t @ pull)
    )
    return Shared(total, covariance, pull)


def beside(score: Scored, common: Shared) -> Scored:
    """A robot's score with what its swarm has in common integrated out."""
    w, t, _ = score
    return Scored(w - w @ common.covariance @ w, t - w @ common.shift, score.square)

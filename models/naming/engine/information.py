"""What data tell of parameters, and of which they tell nothing.

Information is the curvature of half a deviance: (..., p, p), symmetric, not negative. A log need
not hold anything that a parameter changes, and two parameters may change the same: what is not told
has no step and an infinite error, and leaves the others as they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray

FLOOR = 1e-10
"""Of the largest parameter's information, or of one, that a parameter must have: less is rounding
of a numerical derivative. No rule, as all numbers here: tolerances."""
LEAST = 1e-10
"""Eigenvalue, every parameter scaled to an information of one, below which a direction is not told:
two parameters alike to a part in a hundred thousand."""
PART = 1e-6
"""Square of a parameter's share in such directions from which on it is not told itself."""
LEAST_SAND = 1e-12
"""Of the variance that the information gives, least that blocks are taken to give."""


class Inverse(NamedTuple):
    """The inverse of information where it tells something."""

    matrix: FloatArray
    """(..., p, p), without the directions that nothing is told of."""
    told: npt.NDArray[np.bool_]
    """(..., p) parameters that have a value."""

    def step(self, gradient: FloatArray) -> FloatArray:
        """(..., p) Newton step down a gradient (..., p), to be taken off; 0 where none is told."""
        return np.asarray(np.einsum("...pq,...q->...p", self.matrix, gradient))

    @property
    def covariance(self) -> FloatArray:
        """(..., p, p) if errors are white."""
        return self._with_untold(self.matrix)

    def sandwich(self, meat: FloatArray) -> FloatArray:
        """(..., p, p) covariance where the gradient has a variance (..., p, p) of its own.

        Never less than white errors leave. An error that is not told is infinite, and has no
        covariance with the others.
        """
        covariance = self.matrix @ meat @ self.matrix
        plain = np.einsum("...pp->...p", self.matrix)
        sand = np.einsum("...pp->...p", covariance)
        some = plain > 0.0
        least = np.where(some, np.maximum(sand, LEAST_SAND * plain), 1.0)
        grow = np.sqrt(np.where(some, np.maximum(1.0, plain / least), 1.0))
        return self._with_untold(covariance * grow[..., :, None] * grow[..., None, :])

    def _with_untold(self, covariance: FloatArray) -> FloatArray:
        both = self.told[..., :, None] & self.told[..., None, :]
        untold = np.where(self.told, 0.0, np.inf)[..., None, :]
        own = np.eye(covariance.shape[-1], dtype=bool)
        return np.where(both, covariance, np.where(own, untold, 0.0))


def inverted(information: FloatArray) -> Inverse:
    """The inverse of (..., p, p) information."""
    diagonal = np.einsum("...pp->...p", information)
    some = diagonal > FLOOR * np.maximum(diagonal.max(axis=-1, initial=1.0), 1.0)[..., None]
    per = np.where(some, 1.0 / np.sqrt(np.where(some, diagonal, 1.0)), 0.0)
    size, direction = np.linalg.eigh(information * per[..., :, None] * per[..., None, :])
    clear = size > LEAST
    stiff = np.where(clear, 1.0 / np.where(clear, size, 1.0), 0.0)
    matrix = np.einsum("...pk,...k,...qk->...pq", direction, stiff, direction)
    lost = np.einsum("...pk,...k->...p", direction**2, ~clear)
    return Inverse(matrix * per[..., :, None] * per[..., None, :], some & (lost < PART))

"""How strong a fitted term is, and how sure that is."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.hypothesis import Term


def strength(term: Term, coordinates: FloatArray, commands: FloatArray) -> FloatArray:
    """(groups, p) numbers that are 0 at the null: coordinates, or, of a limit, how deep it cuts."""
    if all(np.isfinite(p.null) for p in term.cause.parameters):
        return coordinates
    fastest = float(np.abs(commands).max(initial=1e-9))
    return np.asarray(np.log(np.maximum(fastest / np.maximum(coordinates, 1e-9), 1.0)))


def uncertainty(term: Term, coordinates: FloatArray, covariance: FloatArray) -> FloatArray:
    """(groups, p) standard error of the strength."""
    error: FloatArray = np.sqrt(np.maximum(np.einsum("gpp->gp", covariance), 0.0))
    if all(np.isfinite(p.null) for p in term.cause.parameters):
        return error
    return error / np.maximum(coordinates, 1e-9)

"""How strong a fitted term is, how sure that is, and how far from what healthy robots get."""

from __future__ import annotations

import numpy as np

from embedded_sim.model import FloatArray
from models.identify.fit import Term


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


def distance(
    term: Term,
    coordinates: FloatArray,
    covariance: FloatArray,
    commands: FloatArray,
    mean: FloatArray,
    sd: FloatArray,
    gain: FloatArray,
) -> FloatArray:
    """(groups,) standard deviations between a term's strength and the healthy value.

    Args:
        term: Fitted.
        coordinates: (groups, p).
        covariance: (groups, p, p).
        commands: (rows, 2) of the log.
        mean: (p,) healthy strength.
        sd: (p,) healthy spread.
        gain: (groups,) held-out deviance taken off; all there is for a term whose effect jumps.
    """
    if not term.cause.smooth:
        return np.asarray(np.sqrt(np.maximum(gain, 0.0)))
    away = strength(term, coordinates, commands) - mean
    error = uncertainty(term, coordinates, covariance)
    p = coordinates.shape[1]
    diagonal = np.sqrt(np.maximum(np.einsum("gpp->gp", covariance), 1e-300))
    related = covariance / (diagonal[:, :, None] * diagonal[:, None, :])
    total = related * error[:, :, None] * error[:, None, :] + np.eye(p) * sd**2
    total = total + np.eye(p) * 1e-18
    square = np.einsum("gp,gp->g", away, np.linalg.solve(total, away[:, :, None])[:, :, 0])
    return np.asarray(np.sqrt(np.maximum(square - (p - 1), 0.0)))

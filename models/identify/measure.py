"""How strong a fitted term is, how sure that is, and how far from what healthy robots get."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term
from realitygap.models.identify.residual import weights


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


def jump(problem: Problem, without: Fit, kept: Fit) -> FloatArray:
    """(groups,) how sure a term is whose effect jumps: its dose over its error, by blocks.

    The errors without the term are compared with the change it makes. A real cause has dose 1:
    where the dose is clearly another, the change only happens to help, and the answer is 0.
    """
    w = weights(without.residual, problem.row_scale)
    change = kept.residual - without.residual
    first, block = problem.tracks.first, problem.tracks.block
    slope = np.add.reduceat((w * change * without.residual).sum(axis=1), first)
    bend = np.add.reduceat((w * change * change).sum(axis=1), first)
    curvature = np.maximum(problem.by_group(bend), 1e-12)
    dose = -problem.by_group(slope) / curvature
    left = np.bincount(block, slope + bend * dose[problem.window_group])
    group = problem.window_group[np.searchsorted(block, np.arange(len(left)))]
    meat = np.bincount(group, left**2, problem.count)
    error = np.sqrt(np.maximum(meat, curvature)) / curvature
    whole = np.abs(dose - 1.0) < np.maximum(WHOLE, WHOLE_ERRORS * error)
    return np.where(whole, dose / error, 0.0)


WHOLE = 0.25
WHOLE_ERRORS = 2.5
"""A dose this near to 1, or within so many of its errors, is a whole one."""


def distance(
    term: Term,
    coordinates: FloatArray,
    covariance: FloatArray,
    commands: FloatArray,
    mean: FloatArray,
    sd: FloatArray,
    jumped: FloatArray,
) -> FloatArray:
    """(groups,) standard deviations between a term's strength and the healthy value.

    What the fit does not tell, or nobody has measured in healthy robots, counts for nothing.

    Args:
        term: Fitted.
        coordinates: (groups, p).
        covariance: (groups, p, p).
        commands: (rows, 2) of the log.
        mean: (p,) healthy strength.
        sd: (p,) healthy spread; infinite where it is not known.
        jumped: (groups,) what `jump` says, all there is for a term whose effect jumps.
    """
    if not term.cause.smooth:
        return jumped
    wide = np.hypot(sd, [one.elsewhere for one in term.cause.parameters])
    error = uncertainty(term, coordinates, covariance)
    told = np.isfinite(error) & np.isfinite(wide)
    away = np.where(told, strength(term, coordinates, commands) - mean, 0.0)
    error, wide = np.where(told, error, 0.0), np.where(told, wide, 1.0)
    both = told[:, :, None] & told[:, None, :]
    inside = np.where(both, covariance, 0.0)
    diagonal = np.sqrt(np.maximum(np.einsum("gpp->gp", inside), 1e-300))
    related = inside / (diagonal[:, :, None] * diagonal[:, None, :])
    p = coordinates.shape[1]
    total = related * error[:, :, None] * error[:, None, :]
    total = total + np.eye(p) * (wide**2 + 1e-18)[:, None, :]
    square = np.einsum("gp,gp->g", away, np.linalg.solve(total, away[:, :, None])[:, :, 0])
    free = np.maximum(told.sum(axis=1) - 1, 0)
    return np.asarray(np.sqrt(np.maximum(square - free, 0.0)))

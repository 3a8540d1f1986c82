"""A first look at all robots and all terms at once: one linear step per term.

The errors are compared with the change that a small (or a typical) dose of each term makes. It
costs a replay per dose and says which robots are worth full fits, and what a swarm shares.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.identify.candidates import candidates, own_starts
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Term
from realitygap.models.identify.residual import weights


class Glance(NamedTuple):
    """What one linear step says of a term, per robot."""

    term: Term
    dose: FloatArray
    """(robots,) best multiple of the dose tried."""
    error: FloatArray
    """(robots,) its standard error, by blocks."""
    gain: FloatArray
    """(robots,) deviance that the step promises to take off."""
    unit: FloatArray
    """(p,) coordinates of dose 1."""
    curvature: FloatArray
    """(robots,) deviance that a dose of 1 makes where there is none."""


def glance(problem: Problem, motions: Sequence[Motion] | None = None) -> list[Glance]:
    """Every term's best dose for every group of a problem.

    Args:
        problem: Whose robots.
        motions: (robots,) to start from; None: the problem's base.
    """
    if motions is not None:
        problem = Problem(
            problem.tracks, motions, groups=problem.groups, scale=problem.scale.copy()
        )
    return [one.glance for one in looks(problem)]


class Look(NamedTuple):
    """A glance and what it was taken from."""

    glance: Glance
    change: FloatArray
    """(n, 3) of the errors with dose 1."""
    weight: FloatArray
    """(n, 3) of their squares."""


def looks(problem: Problem) -> Iterator[Look]:
    """Every term at every dose, one after the other."""
    none = problem.residual((), np.zeros((problem.count, 0)))
    scale = problem.scale
    problem.scale = np.maximum(scale, problem.spread(none))
    w = weights(none, problem.row_scale)
    problem.scale = scale
    for term in candidates():
        for unit in _doses(term, problem.tracks.commands):
            try:
                changed = problem.residual((term,), np.tile(unit, (problem.count, 1)))
            except Diverged:
                continue
            change = changed - none
            yield Look(_step(problem, term, unit, none, change, w), change, w)


def _doses(term: Term, commands: FloatArray) -> list[FloatArray]:
    """Coordinates to try: a small step of each parameter, or a jumping term's own starts."""
    if not term.cause.smooth or not all(np.isfinite(p.null) for p in term.cause.parameters):
        return own_starts(term, commands)[:: 3 if not term.cause.smooth else 1]
    steps = np.diag([p.step for p in term.cause.parameters])
    return [*steps, *term.cause.starts(commands)]


def _step(
    problem: Problem,
    term: Term,
    unit: FloatArray,
    errors: FloatArray,
    change: FloatArray,
    w: FloatArray,
) -> Glance:
    """Weighted least squares of the errors on one dose's change."""
    first = problem.tracks.first
    slope = np.add.reduceat((w * change * errors).sum(axis=1), first)
    bend = np.add.reduceat((w * change * change).sum(axis=1), first)
    curvature = np.maximum(problem.by_group(bend), 1e-12)
    dose = -problem.by_group(slope) / curvature
    # gradient at the optimum, by block: its spread is what the dose's error comes from
    left = slope + bend * dose[problem.window_group]
    block = problem.tracks.block
    total = np.bincount(block, left)
    group = problem.window_group[np.searchsorted(block, np.arange(len(total)))]
    meat = np.bincount(group, total**2, problem.count)
    error = np.sqrt(np.maximum(meat, curvature)) / curvature
    return Glance(term, dose, error, dose**2 * curvature, unit, curvature)

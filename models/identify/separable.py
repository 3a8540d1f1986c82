"""Whether a log can tell a cause from one that it is confusable with, whatever the fit says.

Runs differ: tyres wear, clocks are set anew, markers are put on again. A cause counts as told from
another only if it still shows when the other may have a value of its own in every run. Circles of
one radius fail for wheels of two sizes and the distance between them, in whatever direction.
"""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim import Diverged
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.identify.candidates import candidates
from realitygap.models.identify.consistency import leave_one
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.hypothesis import Fit, Term
from realitygap.models.identify.residual import weights

INFLATION = 20.0
"""Factor on a term's variance at which the other may stand in its place: a correlation of 0.975.
Runs of two minutes that wander have 4 at most, real robots' circles 29."""


def inseparable(problem: Problem, kept: Fit, term: Term) -> tuple[Term, ...]:
    """Terms not in a set that the log cannot tell from one of it.

    Args:
        problem: With a single group.
        kept: The set fitted.
        term: One of it.
    """
    change, others = leave_one(problem, kept, term)
    root = np.sqrt(weights(kept.residual, problem.row_scale))
    own = (change * root).ravel()
    given = (others * root[:, :, None]).reshape(len(own), -1)
    alone = _left(own, given)
    names = {t.cause.name for t in kept.terms}
    found = []
    for other in candidates():
        if other.cause.name not in term.cause.confusable_with or other.cause.name in names:
            continue
        column = _column(problem, kept, other)
        if column is None:
            continue
        each = (_by_run(problem, column) * root[:, :, None]).reshape(len(own), -1)
        if alone > INFLATION * _left(own, np.hstack([given, each])):
            found.append(other)
    return tuple(found)


def _column(problem: Problem, kept: Fit, other: Term) -> FloatArray | None:
    """(n, 3) change of the errors with a small dose of another term; None: it has no such dose."""
    parameters = other.cause.parameters
    if len(parameters) > 1 or not other.cause.smooth or not np.isfinite(parameters[0].null):
        return None
    dose = np.hstack([kept.coordinates, [[parameters[0].step]]])
    try:
        return problem.residual((*kept.terms, other), dose) - kept.residual
    except Diverged:
        return None


def _by_run(problem: Problem, column: FloatArray) -> FloatArray:
    """(n, 3, runs) the column in each run alone."""
    segment = problem.tracks.row_segment[problem.tracks.rows]
    return np.stack(
        [np.where((segment == one)[:, None], column, 0.0) for one in np.unique(segment)], axis=2
    )


def _left(own: FloatArray, columns: FloatArray) -> float:
    """Sum of squares that a least-squares fit of the columns leaves."""
    length = np.linalg.norm(columns, axis=0)
    columns = columns[:, length > 0.0] / length[length > 0.0]
    fitted = columns @ np.linalg.lstsq(columns, own, rcond=None)[0]
    return float(np.sum((own - fitted) ** 2))

"""Whether a log can tell a cause from one that it is confusable with, whatever the fit says.

Runs differ: tyres wear, clocks are set anew, markers are put on again. A cause counts as told from
another only if it still shows when the other may have a value of its own in every run. Circles of
one radius fail for wheels of two sizes and the distance between them, in whatever direction.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.fitter import Fitter, Refined
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.state import SWARM


def inseparable(
    fitter: Fitter, terms: Sequence[Term], fit: Refined, term: Term
) -> tuple[Term, ...]:
    """Terms not in a set that the log cannot tell from one of it.

    Args:
        fitter: Of the robots concerned.
        terms: The set.
        fit: Of it.
        term: One of it.
    """
    if not term.cause.confusable_with:
        return ()
    own, given = fitter.changes(terms, fit.coordinates, term)
    alone = _left(own, given)
    names = {t.cause.name for t in terms}
    found = []
    for item in fitter.state.items:
        other = item.term
        if (
            other is None
            or item.dose is not None
            or len(item.columns) > 1
            or (other.cause.place and fitter.scope != SWARM)
            or other.cause.name not in term.cause.confusable_with
            or other.cause.name in names
        ):
            continue
        each = fitter.by_run(item.columns[0])
        if alone > fitter.state.rules.inflation * _left(own, np.hstack([given, each])):
            found.append(other)
    return tuple(found)


def _left(own: FloatArray, columns: FloatArray) -> float:
    """Sum of squares that a least-squares fit of the columns leaves."""
    length = np.linalg.norm(columns, axis=0)
    columns = columns[:, length > 0.0] / length[length > 0.0]
    fitted = columns @ np.linalg.lstsq(columns, own, rcond=None)[0]
    return float(np.sum((own - fitted) ** 2))

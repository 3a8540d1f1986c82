"""Which terms of the catalogue are tried on a log, and from where their fits start."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import causes, withheld
from realitygap.models.belief.cause import Cause
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.engine.hypothesis import Term, Terms

REPRESENTATIVES = ("clock_offset", "weak_motor")
"""Of causes that move poses exactly alike, the one whose parameter may have either sign."""


def candidates() -> tuple[Term, ...]:
    """Every term that can show in poses, one for each set of twins."""
    return tuple(
        Term(cause, variant)
        for cause in causes().values()
        if cause.identifiable
        and not cause.columns
        and not withheld(cause.name)
        and not _represented(cause)
        for variant in cause.variants
    )


def _represented(cause: Cause) -> bool:
    """Whether another cause stands for this one in the search."""
    if cause.name in REPRESENTATIVES:
        return False
    return any(t in REPRESENTATIVES and not withheld(t) for t in cause.twins)


def size(terms: Terms) -> int:
    """Parameters of a hypothesis."""
    return sum(len(term.cause.parameters) for term in terms)


def own_starts(term: Term, commands: FloatArray) -> list[FloatArray]:
    """(parameters,) coordinates from which a term's fit starts, the null first if finite."""
    null = [np.zeros(len(term.cause.parameters))]
    reachable = all(np.isfinite(p.null) for p in term.cause.parameters)
    return [*(null if reachable else []), *term.cause.starts(commands)]


def starts(problem: Problem, term: Term, given: FloatArray) -> list[FloatArray]:
    """(groups, p) starts of a hypothesis that adds a term to one already fitted.

    Args:
        problem: Whose robots.
        term: Added last.
        given: (groups, p0) coordinates of the hypothesis so far.
    """
    own = own_starts(term, problem.tracks.commands)
    return [np.hstack([given, np.tile(start, (problem.count, 1))]) for start in own]

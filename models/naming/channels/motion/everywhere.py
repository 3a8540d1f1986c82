"""Whether a cause is of one size wherever the robot is and whatever it does.

A wheel that is 2 % too large is so in fast motion and in slow, early and late. What only stands in
for something unknown is not: a carpet on half of the floor, taken for smaller wheels, is much there
and nothing elsewhere. A cause's size may differ between the parts of a log
(`motion.parts`) only by as much as chance explains.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.parts import PARTS, parts
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.findings import Where


def uneven(
    fitter: Fitter, terms: Sequence[Term], coordinates: Sequence[FloatArray], term: Term
) -> Where | None:
    """Where a cause's size differs most clearly; None: it is of one size everywhere.

    Args:
        fitter: Of the robots concerned.
        terms: Causes fitted together.
        coordinates: Their values.
        term: One of them.
    """
    rules = fitter.state.rules
    gate = float(chdtri(1, rules.chance / len(PARTS)))
    own, _ = fitter.changes(terms, coordinates, term)
    tracks = fitter.state.tracks.only(fitter.members)
    inside = parts(tracks)
    names = list(inside)
    there = np.array([inside[name] for name in names])[:, np.repeat(tracks.window, 3)]
    rows = [len(fitter.state.robots[k].own_errors) for k in fitter.members]
    columns = np.split((there * own).T, np.cumsum(rows)[:-1])
    score = fitter.beside(terms, coordinates, columns)
    size = np.diag(score.information)
    alone = np.sum([np.sum(one**2, axis=0) for one in columns], axis=0)
    whole = float(own @ own)
    told = (np.minimum(alone, whole - alone) > rules.telling * whole) & (
        size * rules.inflation > alone + EMPTY
    )
    more = np.where(told, score.slope / np.where(told, size, 1.0), 0.0)
    gain = more * score.slope
    clear = (gain > gate) & (np.abs(more) > rules.different)
    if not clear.any():
        return None
    worst = int(np.argmax(np.where(clear, gain, 0.0)))
    most = float(gain[worst])
    return Where(names[worst], float(more[worst]), most, most / max(score.square, most))

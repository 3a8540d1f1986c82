"""Stretches in which something else than the log's commands drove a robot, as its encoders tell.

A robot driven home by hand, or stopped by its emergency switch, does not do what it was told for
seconds. That is no fault, and nothing about one can be learned there.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray

Rows = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

SURELY = 2.0
"""s after which a command must show at the wheels: twice the longest latency of the catalogue."""
TURNS = 0.05
"""Share of the log's fast commands (their 95 % quantile) above which a wheel surely turns."""
FAST = 0.6
"""The same for a command that surely turns a wheel: dead zones are below it."""


def overridden(t: FloatArray, commands: FloatArray, encoders: FloatArray, start: Rows) -> Bools:
    """(rows,) whether wheels turned though told to rest for long, or rested though told to turn.

    Args:
        t: (rows,) s.
        commands: (rows, 2) rad/s.
        encoders: (rows, 2) rad/s measured; NaN where not.
        start: (segments + 1,) first rows, and the row count.
    """
    told, done = np.abs(commands).max(axis=1), np.nan_to_num(np.abs(encoders)).max(axis=1)
    fast = float(np.quantile(told[told > 0.0], 0.95)) if (told > 0.0).any() else np.inf
    new = np.zeros(len(t), dtype=bool)
    new[start[:-1]] = True
    found = np.zeros(len(t), dtype=bool)
    turns = done > TURNS * fast
    for told_so, done_so in ((told == 0.0, turns), (told > FAST * fast, ~turns)):
        begin = new | np.concatenate([[True], np.diff(told_so.astype(np.int8)) != 0])
        piece = np.cumsum(begin) - 1
        late = told_so & done_so & (t - t[begin][piece] > SURELY)
        found |= np.isin(piece, piece[late]) & done_so
    return found

"""Where the other robots of a log were at a robot's moments, whoever was stamped when."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog


class Other(NamedTuple):
    """One robot as seen from rows of others."""

    segment: int
    """Its stretch of the log."""
    rows: Rows
    """(n,) of those asked for, as indices: of its runs, not its own, and while it was seen."""
    place: FloatArray
    """(n, 2) m, between where the tracker saw it before and after."""


def others(log: MeasuredLog, rows: Rows) -> Iterator[Other]:
    """Each robot of the log in turn, in each of its runs.

    Args:
        log: Measured.
        rows: (n,) rows whose moments are asked for.
    """
    t, poses, start, segment = log.t, log.poses, log.start, log.segment[rows]
    runs = np.unique(log.segments["run"].astype(str), return_inverse=True)[1]
    order = np.argsort(runs[segment], kind="stable")
    begin = np.searchsorted(runs[segment][order], np.arange(runs.max() + 2))
    for k, run in enumerate(runs.tolist()):
        seen = np.arange(start[k], start[k + 1])[log.tracked[start[k] : start[k + 1]]]
        if not len(seen):
            continue
        at = order[begin[run] : begin[run + 1]]
        at = at[segment[at] != k]
        there = t[rows[at]]
        during = (there >= t[seen[0]] - log.step) & (there <= t[seen[-1]] + log.step)
        at, there = at[during], there[during]
        place = [np.interp(there, t[seen], poses[seen, axis]) for axis in range(2)]
        yield Other(k, at, np.column_stack(place))

"""Two parts of a log: values are fitted to one and judged on the other, and the other way round.

Of several runs, whole runs are dealt to the parts, so that both last about as long. Of a robot
that is in one part alone (there is one run, or it was not in the others), the time is cut in the
middle: its later half is one part, its earlier half the other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog

PARTS = 2


def parts(log: MeasuredLog) -> Rows:
    """(rows,) part of each row, 0 or 1; a robot's rows in one run are 0 before they are 1."""
    long = np.diff(log.start)
    run = np.unique(log.segments["run"].astype(str), return_inverse=True)[1]
    of_run = _dealt(np.bincount(run, long))
    robot = log.segments["robot"].to_numpy(dtype=np.int64)
    part = np.repeat(of_run[run], long)
    row_robot = np.repeat(robot, long)
    for one in np.unique(robot).tolist():
        mine = row_robot == one
        if len(np.unique(of_run[run[robot == one]])) < PARTS:
            # over all its runs as one after the other
            part[mine] = np.arange(mine.sum()) >= (mine.sum() + 1) // 2
    return part


def _dealt(long: npt.NDArray[Any]) -> Rows:
    """(runs,) the part of each: the longest first, each to the part that is shorter by then."""
    part = np.zeros(len(long), dtype=np.int64)
    total = np.zeros(PARTS)
    for run in np.argsort(-long, kind="stable"):
        part[run] = int(np.argmin(total))
        total[part[run]] += long[run]
    return part

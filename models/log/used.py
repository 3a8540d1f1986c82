"""How much of a log's time a diagnosis of motion uses, robot by robot, and why not the rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog

REASONS = ("used", "contact", "no_pose", "gaps", "too_short", "not_needed")


class Used(NamedTuple):
    """Shares of one robot's time, from the first to the last row of its runs; they sum to 1."""

    robot: int
    seconds: float
    """s altogether."""
    used: float
    """In windows of free motion."""
    contact: float
    """At the wall or at another robot."""
    no_pose: float
    """Not tracked, or a failure of the tracker."""
    gaps: float
    """Rows are missing, or the track jumps."""
    too_short: float
    """Free motion in pieces that are too short for a window."""
    not_needed: float
    """Windows of a long log beyond those that are enough."""


def used(
    log: MeasuredLog, clear: npt.NDArray[np.bool_], windows: Rows, unused: Rows
) -> tuple[Used, ...]:
    """The shares of every robot, by id.

    Args:
        log: Measured.
        clear: (rows,) clear of contact.
        windows: Rows of the log that are in windows.
        unused: Rows in windows that were not needed.
    """
    took = np.append(np.diff(log.t), 0.0)
    took[log.start[1:] - 1] = 0.0
    why = np.full(len(took), REASONS.index("too_short"))
    why[unused] = REASONS.index("not_needed")
    why[~clear] = REASONS.index("contact")
    why[~log.tracked] = REASONS.index("no_pose")
    why[windows] = REASONS.index("used")
    why[np.append(np.diff(log.stretch) != 0, False)] = REASONS.index("gaps")
    robots, who = np.unique(log.frame["robot"].to_numpy(dtype=np.int64), return_inverse=True)
    total = np.zeros((len(robots), len(REASONS)))
    np.add.at(total, (who, why), took)
    seconds = total.sum(axis=1)
    shares = total / np.maximum(seconds, np.finfo(float).tiny)[:, None]
    return tuple(
        Used(int(robot), float(s), *(float(v) for v in row))
        for robot, s, row in zip(robots, seconds, shares, strict=True)
    )

"""Where laws find a robot in a log: at its measured pose, beside the next robot measured there.

A replay of a log asks laws of place, heading and gap where the robot was measured, not where the
replay has carried it: the motion over a window stays the difference of two poses of one replay.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.conditions import nearest_robot
from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog

WHERE = {"heading", "radius", "place", "wall", "gap"}


def around(log: MeasuredLog, drive: Drive) -> FloatArray | None:
    """(rows, 4) x, y (m), yaw (rad), distance to the next robot's middle (m; inf: none).

    None where no law of the drive asks for it. Rows without a pose have the one before them.
    """
    if not asked(drive):
        return None
    gap = nearest_robot(log) if "gap" in asked(drive) else np.full(len(log.t), np.inf)
    return carried_on(np.column_stack([log.poses, gap]), log.tracked, log.start)


def asked(drive: Drive) -> set[str]:
    """Quantities of a drive's laws that tell where a robot is."""
    return WHERE.intersection(atom.of for law in drive.laws for atom in law.atoms)


def carried_on(seen: FloatArray, known: npt.NDArray[np.bool_], start: Rows) -> FloatArray:
    """(rows, ...) numbers, unknown rows as the last known one of their segment.

    Args:
        seen: (rows, ...).
        known: (rows,).
        start: (segments + 1,) first row of each segment, and the row count; those before a
            segment's first known row have that one, or zeros where there is none.
    """
    row = np.arange(len(seen))
    last = np.maximum.accumulate(np.where(known, row, -1))
    begin = np.repeat(start[:-1], np.diff(start))
    after = np.minimum.accumulate(np.where(known, row, len(seen))[::-1])[::-1]
    end = np.repeat(start[1:], np.diff(start))
    at = np.where(last >= begin, last, np.where(after < end, after, -1))
    return np.asarray(np.where((at >= 0)[:, None], seen[at], 0.0))

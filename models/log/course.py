"""The heading of robots whose tracker knows none: where they go, told by the commands which way.

A robot on two wheels moves along its heading. The course at a pose is the direction of the parabola
through it and the poses half of `SPAN` before and after. It is as noisy as two positions make it
over so short a way. A longer way would be quieter, but a diagnosis would count the same positions
twice: over a tenth of a window, courses add less than a tenth to what positions tell of turns.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows
from realitygap.models.log.tracker import NORMAL

SPAN = 0.1
"""s between the positions that a course is taken from, or two rows where rows are rarer."""
CLEARLY = 8.0
"""Standard deviations of a position's noise that a robot must have moved: its course is then known
within 0.2 rad. Our choice."""
SETTLED = 0.5
"""s without a reversal: motors obey later than they are told, by 0.3 s in real robots."""
SCALE = NORMAL / np.sqrt(6.0)
"""Standard deviations of noise in a median absolute second difference."""


def courses(
    t: FloatArray, places: FloatArray, commands: FloatArray, segment: Rows
) -> tuple[FloatArray, float]:
    """(rows,) yaw (rad), NaN where a robot hardly moves or has just reversed; its usual noise.

    Args:
        t: (rows,) s.
        places: (rows, 2) measured x and y (m), NaN where lost.
        commands: (rows, 2) told to the left and the right wheel (rad/s).
        segment: (rows,) which robot in which run.
    """
    yaw = np.full(len(t), np.nan)
    lost = np.isnan(places).any(axis=1)
    repeated = np.append(False, (np.diff(places, axis=0) == 0.0).all(axis=1))
    rows = np.flatnonzero(~lost & ~repeated)
    if len(rows) < 3:
        return yaw, np.nan
    step = float(np.median(np.diff(t[rows])[np.diff(segment[rows]) == 0]))
    apart = max(1, round(0.5 * SPAN / step)) if step > 0.0 else 1
    before, middle, after = rows[: -2 * apart], rows[apart:-apart], rows[2 * apart :]
    first, second = (t[middle] - t[before])[:, None], (t[after] - t[middle])[:, None]
    whole = (segment[before] == segment[after]) & (t[after] - t[before] < 3.0 * apart * step)
    if not whole.any():
        return yaw, np.nan
    bend = places[before] - 2.0 * places[middle] + places[after]
    noise = float(SCALE * np.median(np.abs(bend[whole])))
    moved = (places[after] - places[middle]) / second * first
    moved = moved + (places[middle] - places[before]) / first * second
    ahead, settled = _told(t, commands, segment)
    moved *= ahead[middle, None]
    far = np.hypot(*moved.T)
    known = whole & settled[middle] & (ahead[after] == ahead[middle]) & (far > CLEARLY * noise)
    yaw[middle[known]] = np.arctan2(moved[known, 1], moved[known, 0])
    return yaw, np.sqrt(2.0) * noise / float(np.median(far[known])) if known.any() else np.nan


def _told(
    t: FloatArray, commands: FloatArray, segment: Rows
) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """(rows,) 1 ahead, -1 back, 0 neither; and whether it has been so for long enough."""
    ahead = np.sign(commands.sum(axis=1))
    changed = np.append(True, (np.diff(ahead) != 0.0) | (np.diff(segment) != 0))
    since = t - t[np.flatnonzero(changed)[np.cumsum(changed) - 1]]
    return ahead, (ahead != 0.0) & (since >= SETTLED)

"""How long a belief outlives the world it was true of (paper, IV-C: about 7 minutes)."""

from __future__ import annotations

import numpy as np

from realitygap.studies.paper.tables import Array, StudyTables

BEFORE = 10
"""Minutes before the lamp moves whose mean is the level to fall from; our choice."""
SMOOTH = 3
"""Minutes of running mean over the swarm's mean curve; our choice."""


def old_third_curves(tables: StudyTables, condition: str, scenario: int) -> Array:
    """Share of robots that believe a scenario in each minute: (runs, minutes)."""
    rows = tables.generations[tables.generations["condition"] == condition]
    believes = (rows["s0_third"] == scenario).astype(float)
    minutes = max(1, round(tables.minutes))
    minute = np.minimum(rows["minute"].astype(int), minutes - 1)
    curves = believes.groupby([rows["index"], minute]).mean().unstack(level=1)
    whole = curves.reindex(columns=range(minutes))
    return whole.ffill(axis=1).bfill(axis=1).to_numpy(dtype=np.float64)


def half_life(curves: Array, switch: int) -> float:
    """Minutes after `switch` until the mean curve has fallen half-way to where it ends.

    Args:
        curves: (runs, minutes) share of robots.
        switch: The first minute of the new world.

    Returns:
        The minutes, between two by a straight line, the time left if it never gets there, NaN if
        there was nothing to fall.
    """
    if switch < 1:
        return float("nan")
    mean = curves.mean(axis=0)
    held = float(mean[max(0, switch - BEFORE) : switch].mean())
    left = float(mean[switch + (len(mean) - switch) // 2 :].mean())
    if not held > left:
        return float("nan")
    middle = (held + left) / 2.0
    smooth = np.convolve(np.pad(mean, SMOOTH // 2, mode="edge"), np.ones(SMOOTH) / SMOOTH, "valid")
    after = smooth[switch:]
    fallen = np.flatnonzero(after <= middle)
    if not fallen.size:
        return float(len(after))
    at = int(fallen[0])
    if not at:
        return 0.0
    return at - float((middle - after[at]) / (after[at - 1] - after[at]))

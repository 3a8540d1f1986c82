"""How long a belief outlives the world it was true of, and how soon a swarm earns as before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from realitygap.studies.paper.tables import Array, StudyTables

BEFORE = 10
"""Minutes before the lamp moves whose mean is the level to fall from; our choice."""
SMOOTH = 3
"""Minutes of running mean over the swarm's mean curve; our choice."""
BACK = 0.8
"""Of the old rate, at which a swarm has adapted; the figure of later work on the same question."""


def old_third_curves(tables: StudyTables, key: str, scenario: int) -> Array:
    """Share of robots that believe a scenario in each minute: (runs, minutes)."""
    believes = tables.generations["s0_third"].eq(scenario).fillna(False).astype(float)
    believing = replace(tables, generations=tables.generations.assign(believes=believes))
    return believing.curves(key, "believes")


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
    smooth = _smooth(mean)
    after = smooth[switch:]
    fallen = np.flatnonzero(after <= middle)
    if not fallen.size:
        return float(len(after))
    at = int(fallen[0])
    if not at:
        return 0.0
    return at - float((middle - after[at]) / (after[at - 1] - after[at]))


def recovery(curves: Array, switch: int) -> float:
    """Minutes after `switch` until the mean curve is back at `BACK` of what it was.

    Args:
        curves: (runs, minutes) of what is earned.
        switch: The first minute of the new world.

    Returns:
        From the move to the first such minute after the lowest of the first `BEFORE`; 0 if it never
        falls below, the time left if it never comes back, NaN if nothing was earned.
    """
    if switch < 1:
        return float("nan")
    mean = curves.mean(axis=0)
    enough = BACK * float(mean[max(0, switch - BEFORE) : switch].mean())
    after = _smooth(mean)[switch:]
    if not enough > 0.0:
        return float("nan")
    lowest = int(np.argmin(after[:BEFORE]))
    if after[lowest] >= enough:
        return 0.0
    back = np.flatnonzero(after[lowest:] >= enough)
    return float(lowest + back[0]) if back.size else float(len(after))


def _smooth(mean: Array) -> Array:
    padded = np.pad(mean, SMOOTH // 2, mode="edge")
    return np.convolve(padded, np.ones(SMOOTH) / SMOOTH, "valid")

"""When commands changed, where the rows of a log do not quite say it.

A log that misses rows shows every change of a command at a wrong time, by up to a row. A robot
repeats itself: of its changes of one kind all may be shown late, of another none. So what scatters
between windows need not even out over the windows of a robot. Each kind of change has a delay of
its own in each robot, as large as the scatter that the log shows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.flexible import Steps, axles
from realitygap.models.naming.channels.motion.tracks import Tracks

NAME = "timing"
KINDS = tuple(kind for kind in product((-1, 0, 1), repeat=2) if any(kind))
"""Of changes: whether the left and the right wheel are told to turn less, alike or more forward."""


def changes_late(
    steps: Steps, tracks: Tracks, motions: Sequence[Motion]
) -> Iterator[tuple[str, FloatArray]]:
    """Every kind of change with (n, 3) changes of the predicted poses, per second that it is late.

    Args:
        steps: Of the predicted path.
        tracks: Of some robots.
        motions: One per robot.
    """
    change = np.diff(tracks.commands, axis=0, prepend=tracks.commands[:1])
    before = np.maximum(tracks.rows - 1, 0)  # a row's pose knows nothing of its own command yet
    radii = np.array([motion.drive.wheel_radius for motion in motions])
    radius = radii[tracks.robot[tracks.window]]
    axle = axles(tracks, motions)
    for kind in KINDS:
        of_kind = (np.sign(change) == kind).all(axis=1)
        told = np.cumsum(np.where(of_kind[:, None], change, 0.0), axis=0)[before]
        lost = np.diff(told, axis=0, prepend=told[:1]) * radius
        lost[tracks.first] = 0.0
        left, right = -lost.T
        ahead, turn = 0.5 * (left + right), (right - left) / axle
        yield _name(kind), steps.carried(ahead, np.zeros_like(ahead), turn)


def timed(names: Sequence[str], scatter: float) -> dict[str, float]:
    """By name of a column, the standard deviation (s) by which sound robots of a log may differ.

    Args:
        names: Of the columns that there are.
        scatter: s, standard deviation of every window's own time, of this log.
    """
    return {_name(kind): scatter for kind in KINDS if _name(kind) in names}


def _name(kind: Sequence[int]) -> str:
    return f"{NAME}@{kind[0]:+d}{kind[1]:+d}"

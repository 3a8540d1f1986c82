"""Poses in the plane: motion between two poses, seen from the first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray

Rows = npt.NDArray[np.int64]


class Windows(NamedTuple):
    """Pairs of rows of a log."""

    first: Rows
    """(windows,) row at the start."""
    last: Rows
    """(windows,) row at the end."""


def motion(poses: FloatArray, pairs: Windows) -> FloatArray:
    """(windows, 3) how a pose changed over each window: m ahead, m to the left, rad (wrapped)."""
    change = poses[pairs.last] - poses[pairs.first]
    c, s = np.cos(poses[pairs.first, 2]), np.sin(poses[pairs.first, 2])
    along = c * change[:, 0] + s * change[:, 1]
    across = c * change[:, 1] - s * change[:, 0]
    return np.column_stack([along, across, wrapped(change[:, 2])])


def moved(poses: FloatArray, motions: FloatArray) -> FloatArray:
    """(n, 3) poses after motions, the inverse of `motion`."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    return np.column_stack(
        [
            poses[:, 0] + c * motions[:, 0] - s * motions[:, 1],
            poses[:, 1] + s * motions[:, 0] + c * motions[:, 1],
            poses[:, 2] + motions[:, 2],
        ]
    )


def wrapped(angle: FloatArray) -> FloatArray:
    """Angles (rad) as the same directions in [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi

"""A tracker whose clock is late: the poses it reports now are from some time ago."""

from __future__ import annotations

import numpy as np

from realitygap.reality import constants as k
from realitygap.reality.hardware import FloatArray


class Past:
    """The robots' poses at the last physics steps, and between two of them on a straight line."""

    def __init__(self, delay: FloatArray, poses: FloatArray) -> None:
        """Remember as far back as the latest clock needs.

        Args:
            delay: (robots,) s.
            poses: (robots, 3) where the robots are, and have always been.
        """
        steps = delay / k.PHYSICS_STEP
        whole = np.floor(steps + 1e-9)
        self._whole, self._part = whole.astype(np.intp), np.maximum(steps - whole, 0.0)[:, None]
        self._poses: FloatArray = np.repeat(poses[None], int(self._whole.max()) + 2, axis=0)
        self._rows = np.arange(len(delay))
        self._newest = 0

    def add(self, poses: FloatArray) -> None:
        """A physics step later the robots are at poses (robots, 3)."""
        self._newest += 1
        self._poses[self._newest % len(self._poses)] = poses

    def late(self) -> FloatArray:
        """(robots, 3): where each robot was when its clock says it is now."""
        at = self._newest - self._whole
        later = self._poses[at % len(self._poses), self._rows]
        back = self._poses[(at - 1) % len(self._poses), self._rows] - later
        back[:, 2] = np.remainder(back[:, 2] + np.pi, 2.0 * np.pi) - np.pi
        return later + self._part * back

"""How measured paths differ from predicted ones once place and heading of each window are free.

The predicted path of a window is shifted and turned to fit the measured one by weighted least
squares; what is left is expressed ahead and to the left of the robot and divided by the tracker's
noise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import wrapped
from realitygap.models.naming.channels.motion.tracks import Tracks


class Aligned(NamedTuple):
    """A prediction, each window shifted and turned to where it was measured; all rows in its frame.

    (n,) each, in m and rad.
    """

    path: FloatArray
    """(n, 2) predicted positions about the window's middle."""
    heading: FloatArray
    """Predicted yaw."""
    apart: FloatArray
    """(n, 3) measured less predicted pose before the window's remaining turn."""
    turn: FloatArray
    """The window's remaining turn, by weighted least squares over place and heading."""
    stiff: FloatArray
    """1/rad^2: curvature of the squared errors, in noise, with that turn."""


class Residuals:
    """Residuals of one set of tracks; keeps what does not depend on the prediction."""

    def __init__(self, tracks: Tracks) -> None:
        self._first, self._window = tracks.first, tracks.window
        self._count = np.diff(np.append(tracks.first, len(tracks.rows))).astype(np.float64)
        self._sp, self._sy = tracks.noise.position, tracks.noise.heading
        self._yaw = tracks.measured[:, 2]
        self._place = self._centred(tracks.measured[:, :2])

    def _sum(self, values: FloatArray) -> FloatArray:
        """(n, ...) each row's window sum."""
        return np.asarray(np.add.reduceat(values, self._first, axis=0)[self._window])

    def _mean(self, values: FloatArray) -> FloatArray:
        """(n, ...) each row's window mean."""
        total = np.add.reduceat(values, self._first, axis=0)
        return np.asarray((total.T / self._count).T[self._window])

    def _centred(self, values: FloatArray) -> FloatArray:
        return values - self._mean(values)

    def __call__(self, predicted: FloatArray) -> FloatArray:
        """(n, 3) errors ahead, to the left and in heading, in standard deviations of noise.

        Args:
            predicted: (n, 3) poses, each segment in a frame of its own.
        """
        at = self.aligned(predicted)
        return self._ahead(self._turned(at.apart, at.path, at.turn), at.heading)

    def aligned(self, predicted: FloatArray) -> Aligned:
        """The windows of (n, 3) predicted poses where they were measured."""
        path, heading = self._centred(predicted[:, :2]), predicted[:, 2]
        turned = wrapped(self._yaw - heading)
        about = turned[self._first][self._window]
        frame = about + self._mean(wrapped(turned - about))
        c, s = np.cos(frame), np.sin(frame)
        x = c * self._place[:, 0] + s * self._place[:, 1] - path[:, 0]
        y = c * self._place[:, 1] - s * self._place[:, 0] - path[:, 1]
        apart = np.column_stack([x, y, wrapped(turned - frame)])
        wp, wy = 1.0 / self._sp**2, 1.0 / self._sy**2
        pull = (y * path[:, 0] - x * path[:, 1]) * wp + apart[:, 2] * wy
        stiff = (path[:, 0] ** 2 + path[:, 1] ** 2) * wp + wy
        pull, stiff = self._sum(np.column_stack([pull, stiff])).T
        return Aligned(path, heading, apart, pull / stiff, stiff)

    def derivative(self, at: Aligned, change: FloatArray) -> FloatArray:
        """(n, 3) how the errors change with a small change of the predicted poses.

        A changed heading turns the whole window in the frame of the prediction; shift and turn of
        the window follow.

        Args:
            at: Where the prediction is.
            change: (n, 3) change of the prediction per unit of something.
        """
        (px, py), (x, y, _) = at.path.T, at.apart.T
        dx, dy = self._centred(change[:, :2]).T
        swing = self._mean(change[:, 2])
        # the measured window turns by -swing about its middle, the predicted path moves by (dx, dy)
        moved = np.column_stack(
            [-swing * (y + py) - dx, swing * (x + px) - dy, swing - change[:, 2]]
        )
        wp, wy = 1.0 / self._sp**2, 1.0 / self._sy**2
        pull = moved[:, 1] * px + y * dx - moved[:, 0] * py - x * dy
        total = self._sum(
            np.column_stack([pull * wp + moved[:, 2] * wy, 2.0 * (px * dx + py * dy) * wp])
        )
        turn = (total[:, 0] - at.turn * total[:, 1]) / at.stiff
        left = self._turned(moved, at.path, turn)
        left[:, :2] += at.turn[:, None] * np.column_stack([dy, -dx])
        found = self._ahead(left, at.heading)
        # the robot's own axes turn as well
        ahead, aside, _ = self._ahead(self._turned(at.apart, at.path, at.turn), at.heading).T
        found[:, :2] += change[:, 2, None] * np.column_stack([aside, -ahead])
        return found

    def _turned(self, apart: FloatArray, path: FloatArray, turn: FloatArray) -> FloatArray:
        """(n, 3) what is apart once each window has turned."""
        return apart - turn[:, None] * np.column_stack(
            [-path[:, 1], path[:, 0], np.ones(len(path))]
        )

    def _ahead(self, apart: FloatArray, heading: FloatArray) -> FloatArray:
        """(n, 3) the same ahead, to the left and in heading, in standard deviations of noise."""
        (x, y, yaw), c, s = apart.T, np.cos(heading), np.sin(heading)
        return np.column_stack(
            [(c * x + s * y) / self._sp, (c * y - s * x) / self._sp, yaw / self._sy]
        )


def deviance(residual: FloatArray, scale: FloatArray | float, freedom: float) -> FloatArray:
    """(n,) -2 log likelihood of the rows' Student-t errors, up to a constant."""
    z = residual / scale
    return np.asarray((freedom + 1.0) * np.log1p(z**2 / freedom).sum(axis=1))


def weights(residual: FloatArray, scale: FloatArray | float, freedom: float) -> FloatArray:
    """(n, 3) weights of squared errors at which least squares has the deviance's optimum."""
    z = residual / scale
    return np.asarray((freedom + 1.0) / (freedom + z**2) / np.square(scale))

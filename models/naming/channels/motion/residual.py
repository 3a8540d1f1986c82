"""How measured paths differ from predicted ones once place and heading of each window are free.

The predicted path of a window is shifted and turned to fit the measured one by weighted least
squares; what is left is expressed ahead and to the left of the robot and divided by the tracker's
noise.
"""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import wrapped
from realitygap.models.naming.channels.motion.tracks import Tracks


class Residuals:
    """Residuals of one set of tracks; keeps what does not depend on the prediction."""

    def __init__(self, tracks: Tracks) -> None:
        self._first, self._window = tracks.first, tracks.window
        self._count = np.diff(np.append(tracks.first, len(tracks.rows))).astype(np.float64)
        self._sp, self._sy = tracks.noise.position, tracks.noise.heading
        self._yaw = tracks.measured[:, 2]
        self._place = self.centred(tracks.measured[:, :2])

    def _sum(self, values: FloatArray) -> FloatArray:
        """(n, ...) each row's window sum."""
        return np.asarray(np.add.reduceat(values, self._first, axis=0)[self._window])

    def _mean(self, values: FloatArray) -> FloatArray:
        """(n, ...) each row's window mean."""
        total = np.add.reduceat(values, self._first, axis=0)
        return np.asarray((total.T / self._count).T[self._window])

    def centred(self, values: FloatArray) -> FloatArray:
        """(n, ...) less each row's window mean."""
        return values - self._mean(values)

    def __call__(self, predicted: FloatArray) -> FloatArray:
        """(n, 3) errors ahead, to the left and in heading, in standard deviations of noise.

        Args:
            predicted: (n, 3) poses, each segment in a frame of its own.
        """
        path, heading = self.centred(predicted[:, :2]), predicted[:, 2]
        turned = wrapped(self._yaw - heading)
        about = turned[self._first][self._window]
        frame = about + self._mean(wrapped(turned - about))
        c, s = np.cos(frame), np.sin(frame)
        x = c * self._place[:, 0] + s * self._place[:, 1] - path[:, 0]
        y = c * self._place[:, 1] - s * self._place[:, 0] - path[:, 1]
        yaw = wrapped(turned - frame)
        wp, wy = 1.0 / self._sp**2, 1.0 / self._sy**2
        pull = (y * path[:, 0] - x * path[:, 1]) * wp + yaw * wy
        stiff = (path[:, 0] ** 2 + path[:, 1] ** 2) * wp + wy
        pull, stiff = self._sum(np.column_stack([pull, stiff])).T
        turn = pull / stiff  # the window's remaining one, by weighted least squares
        apart = np.column_stack([x, y, yaw])
        apart -= turn[:, None] * np.column_stack([-path[:, 1], path[:, 0], np.ones(len(path))])
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

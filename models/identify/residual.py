"""How measured paths differ from predicted ones once place and heading of each window are free.

The predicted path of a window is shifted and turned to fit the measured one by weighted least
squares; what is left is expressed ahead and to the left of the robot and divided by the tracker's
noise.
"""

from __future__ import annotations

import numpy as np

from embedded_sim.model import FloatArray
from models.frames import wrapped
from models.identify.tracks import Tracks


class Fitter:
    """Residuals of one set of tracks; keeps what does not depend on the prediction."""

    def __init__(self, tracks: Tracks) -> None:
        self._first, self._window = tracks.first, tracks.window
        self._count = np.diff(np.append(tracks.first, len(tracks.rows))).astype(np.float64)
        self._sp, self._sy = tracks.noise.position, tracks.noise.heading
        self._yaw = tracks.measured[:, 2]
        self._place = self._centred(tracks.measured[:, :2])

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
        path, heading = self._centred(predicted[:, :2]), predicted[:, 2]
        turned = wrapped(self._yaw - heading)
        about = turned[self._first][self._window]
        frame = about + self._mean(wrapped(turned - about))
        c, s = np.cos(frame), np.sin(frame)
        x = c * self._place[:, 0] + s * self._place[:, 1] - path[:, 0]
        y = c * self._place[:, 1] - s * self._place[:, 0] - path[:, 1]
        yaw = wrapped(turned - frame)
        # the window's remaining turn, by weighted least squares over place and heading
        wp, wy = 1.0 / self._sp**2, 1.0 / self._sy**2
        pull = (y * path[:, 0] - x * path[:, 1]) * wp + yaw * wy
        stiff = (path[:, 0] ** 2 + path[:, 1] ** 2) * wp + wy
        total = np.add.reduceat(np.column_stack([pull, stiff]), self._first, axis=0)
        turn = (total[:, 0] / total[:, 1])[self._window]
        x, y, yaw = x + turn * path[:, 1], y - turn * path[:, 0], yaw - turn
        c, s = np.cos(heading), np.sin(heading)
        return np.column_stack(
            [(c * x + s * y) / self._sp, (c * y - s * x) / self._sp, yaw / self._sy]
        )

    def derivative(self, path: FloatArray, change: FloatArray, heading: FloatArray) -> FloatArray:
        """(n, 3) how residuals change with a small change of the predicted poses.

        Args:
            path: (n, 2) predicted positions.
            change: (n, 3) change of the prediction per unit of something.
            heading: (n,) predicted yaw.
        """
        path = self._centred(path)
        d = -self._centred(change)
        wp, wy = 1.0 / self._sp**2, 1.0 / self._sy**2
        pull = (d[:, 1] * path[:, 0] - d[:, 0] * path[:, 1]) * wp + d[:, 2] * wy
        stiff = (path[:, 0] ** 2 + path[:, 1] ** 2) * wp + wy
        total = np.add.reduceat(np.column_stack([pull, stiff]), self._first, axis=0)
        turn = (total[:, 0] / total[:, 1])[self._window]
        x, y = d[:, 0] + turn * path[:, 1], d[:, 1] - turn * path[:, 0]
        c, s = np.cos(heading), np.sin(heading)
        yaw = d[:, 2] - turn
        return np.column_stack(
            [(c * x + s * y) / self._sp, (c * y - s * x) / self._sp, yaw / self._sy]
        )


DEGREES = 5.0
"""Of freedom of the Student-t errors: one to four per cent of a real tracker's poses are wild."""


def deviance(residual: FloatArray, scale: FloatArray | float = 1.0) -> FloatArray:
    """(n,) -2 log likelihood of the rows' errors, up to a constant."""
    z = residual / scale
    return np.asarray((DEGREES + 1.0) * np.log1p(z**2 / DEGREES).sum(axis=1))


def weights(residual: FloatArray, scale: FloatArray | float = 1.0) -> FloatArray:
    """(n, 3) weights of squared errors at which least squares has the deviance's optimum."""
    z = residual / scale
    return np.asarray((DEGREES + 1.0) / (DEGREES + z**2) / np.square(scale))

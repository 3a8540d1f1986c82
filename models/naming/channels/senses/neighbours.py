"""The other robots around each row of a log, and which sensors they can have to do with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.others import others

Bools = npt.NDArray[np.bool_]
Rows = npt.NDArray[np.int64]

TALLEST = 0.085
"""m: the upper end of an e-puck with its extension board (0.075 m) and a margin; light that passes
above throws no shadow. No rule: of the body."""
MARGIN = 0.012
"""m around a body that a ray must miss by: the ring of sensors may be turned by some degrees.
No rule: of the body."""
FAR = 1e6
"""m: where a robot that was not seen at a moment is put. No rule: as good as infinite."""


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Places of the others."""

    place: FloatArray
    """(rows, others, 2) m; `FAR` where there is none."""

    def only(self, chosen: Bools | Rows) -> Neighbours:
        """Of some rows."""
        return Neighbours(self.place[chosen])

    def in_ray(self, poses: FloatArray, model: PointModel) -> Bools:
        """(rows, 8) another robot can be in the infrared sensor's ray."""
        assert model.tables is not None
        reach = model.tables.ps_range + 2.0 * model.body_radius + MARGIN
        hit = np.zeros((len(poses), len(model.sensor_angles)), dtype=np.bool_)
        row, other = np.nonzero(self._apart(poses) < reach)
        x, y = self._from(poses, row, other)
        for k, angle in enumerate(model.sensor_angles):
            c, s = np.cos(poses[row, 2] + angle), np.sin(poses[row, 2] + angle)
            ahead, aside = c * x + s * y, np.abs(c * y - s * x)
            blocked = (ahead > 0.0) & (aside < model.body_radius + MARGIN)
            np.logical_or.at(hit[:, k], row, blocked)
        return hit

    def before_lamp(self, poses: FloatArray, lamp: tuple[float, float], model: PointModel) -> Bools:
        """(rows, 8) another robot can be between the sensor and the lamp."""
        rise = model.lamp_height - model.sensor_height
        low = min(1.0, max(TALLEST - model.sensor_height, 0.0) / max(rise, 1e-6))
        radius = model.body_radius + MARGIN
        shaded = np.zeros((len(poses), len(model.sensor_angles)), dtype=np.bool_)
        there = np.hypot(lamp[0] - poses[:, 0], lamp[1] - poses[:, 1])
        row, other = np.nonzero(self._apart(poses) < low * there[:, None] + 2.0 * radius)
        x, y = self._from(poses, row, other)
        for k, angle in enumerate(model.sensor_angles):
            yaw = poses[row, 2] + angle
            px, py = model.body_radius * np.cos(yaw), model.body_radius * np.sin(yaw)
            vx, vy = lamp[0] - poses[row, 0] - px, lamp[1] - poses[row, 1] - py
            length = np.maximum(np.hypot(vx, vy), 1e-9)
            ahead = ((x - px) * vx + (y - py) * vy) / length
            aside = np.abs((x - px) * vy - (y - py) * vx) / length
            half = np.sqrt(np.maximum(radius**2 - aside**2, 0.0))
            blocked = (aside < radius) & (ahead + half > 0.0) & (ahead - half < low * length)
            np.logical_or.at(shaded[:, k], row, blocked)
        return shaded

    def _apart(self, poses: FloatArray) -> FloatArray:
        """(rows, others) m between centres."""
        away = self.place - poses[:, None, :2]
        return np.asarray(np.hypot(away[..., 0], away[..., 1]))

    def _from(self, poses: FloatArray, row: Rows, other: Rows) -> tuple[FloatArray, FloatArray]:
        away = self.place[row, other] - poses[row, :2]
        return away[:, 0], away[:, 1]


def around(log: MeasuredLog, rows: Rows) -> Neighbours:
    """The others at the moment of each row."""
    robots, who = np.unique(log.segments["robot"].to_numpy(dtype=np.int64), return_inverse=True)
    place = np.full((len(rows), len(robots), 2), FAR)
    for robot, at, there in others(log, rows):
        place[at, who[robot]] = there
    return Neighbours(place)

"""Channels of one number: how infrared scatters, and what other robots reflect of it.

Each has a standard error and is shifted by causes: a row of the mixed model like any other.
"""

from __future__ import annotations

import math

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.senses.predicted import LEAST_TELLING, TELLING, read
from realitygap.models.naming.channels.senses.readings import ReadingRows
from realitygap.models.naming.channels.senses.sight import Sight

MIDDLE = 0.4549
"""Median of the square of a standard normal variable. No rule: of statistics."""
OF_SCALE, OF_MEDIAN = 1.17, 1.2533
"""Standard errors of the logarithm of a median absolute deviation, and of a median, times the
square root of the number. No rule: of statistics."""
SQUARE = 0.7
"""Of a robot's radius within which a ray surely meets it. No rule: of its round shape."""
LEAST_LEVEL = 1e-3
"""Least standard error of a logarithm: whole counts of a thousand are no closer.
No rule: of rounding."""
TOUCHING = 0.002
"""m nearer than which a robot is not where the tracker's noise has it. No rule: of trackers."""


class Level:
    """One number of a robot, and its standard error."""

    def __init__(self, name: str, kinds: tuple[str, ...], value: float, error: float) -> None:
        self.name, self.kinds, self.part = name, kinds, -1
        self._value, self._error = value, error
        self.window = self.first = np.zeros(1, dtype=np.int64)

    def errors(self, belief: Belief) -> FloatArray:
        """(1,) in standard errors."""
        return np.array([(self._value - self.told(belief)) / self._error])

    def told(self, belief: Belief) -> float:
        """What is believed of it: of all sensors' readings the middle one, which a dead sensor does
        not move."""
        return math.log(max(float(np.median(belief.senses.ps_gain)), 1e-3))

    @property
    def per_unit(self) -> float:
        """Errors per unit of the number."""
        return 1.0 / self._error


class Scatter(Level):
    """Logarithm of how much infrared scatters over what is expected, in one part of the log.

    Of the variance expected only a share is the sensors' own noise; the rest is the pose's.
    """

    def __init__(self, channel: ReadingRows, square: FloatArray, belief: Belief, part: int) -> None:
        """Prepare.

        Args:
            channel: Of infrared.
            square: (n,) of the readings' errors in noise, beside everything that explains them.
            belief: At which the noise was told.
            part: Of the log.
        """
        mine = (channel.eye.sight.part[channel.row] == part) & (channel.signal > TELLING)
        some = square[mine]
        self.enough = len(some) >= LEAST_TELLING
        value = 0.5 * math.log(float(np.median(some)) / MIDDLE) if self.enough else 0.0
        super().__init__("scatter", ("noise",), value, OF_SCALE / max(len(some), 1) ** 0.5)
        self.part = part
        self._share = float(np.median(channel.own[mine])) if self.enough else 1.0
        self._scale = belief.senses.ps_noise

    def told(self, belief: Belief) -> float:
        """What is believed of it."""
        ratio = (belief.senses.ps_noise / self._scale) ** 2
        return 0.5 * math.log(self._share * ratio + 1.0 - self._share)


def targets(sight: Sight, model: PointModel) -> Level | None:
    """Logarithm of what one robot's infrared reads of other robots over a wall's reading there;
    None: too seldom was one surely in a ray."""
    tables = model.tables
    assert tables is not None
    expected = read(sight, model, np.arange(len(sight.time)))
    ratios, blocks = [], []
    away = sight.neighbours.place - sight.poses[:, None, :2]
    near = np.hypot(away[..., 0], away[..., 1]) < tables.ps_range + 2.0 * model.body_radius
    row, other = np.nonzero(near & (near.sum(axis=1) == 1)[:, None])
    x, y = away[row, other].T
    radius = model.body_radius
    for k, angle in enumerate(model.sensor_angles):
        c, s = np.cos(sight.poses[row, 2] + angle), np.sin(sight.poses[row, 2] + angle)
        ahead, aside = c * x + s * y, np.abs(c * y - s * x)
        deep = np.sqrt(np.maximum(radius**2 - aside**2, 0.0))
        distance = ahead - deep - radius
        sure = (ahead > 0.0) & (aside < SQUARE * radius) & (distance > TOUCHING)
        sure &= (distance < tables.ps_range) & (expected[row, k] < 2.0)
        told = _looked_up(tables.ps_counts[k], distance / tables.ps_range, deep / radius)
        seen = sight.read[row, k]
        sure &= np.isfinite(seen) & (told > TELLING)
        ratios.append(seen[sure] / told[sure])
        blocks.append(sight.block[row][sure])
    ratio, block = np.concatenate(ratios), np.concatenate(blocks)
    middle = float(np.median(ratio)) if len(ratio) >= LEAST_TELLING else 0.0
    if middle <= 0.0:
        return None
    wide = NORMAL * float(np.median(np.abs(ratio - middle)))
    pull = np.bincount(block, np.sign(ratio - middle))
    signs = max(float((pull**2).sum()), len(ratio))  # of few blocks that chance made to cancel
    error = max(OF_MEDIAN * wide * np.sqrt(signs) / len(ratio) / middle, LEAST_LEVEL)
    return Level("targets", ("ps",), float(np.log(middle)), float(error))


def _looked_up(counts: FloatArray, near: FloatArray, incidence: FloatArray) -> FloatArray:
    """(n,) of a table (distances, incidences), as the point model looks it up."""
    distances, incidences = counts.shape
    u = np.sqrt(np.clip(near, 0.0, 1.0)) * (distances - 1)
    v = np.clip(incidence, 0.0, 1.0) * (incidences - 1)
    i, j = np.minimum(u.astype(int), distances - 2), np.minimum(v.astype(int), incidences - 2)
    a, b = u - i, v - j
    low = (1 - b) * counts[i, j] + b * counts[i, j + 1]
    high = (1 - b) * counts[i + 1, j] + b * counts[i + 1, j + 1]
    return np.asarray((1 - a) * low + a * high, dtype=np.float64)

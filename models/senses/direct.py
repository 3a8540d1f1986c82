"""What is seen without a fit: dead sensors, noise, and what infrared reads of other robots."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.senses.sight import Bools, Sight

DEAD_SHARE = 0.005
"""Largest share of readings other than zero of a dead infrared sensor."""
TELLING = 20.0
"""counts that must be expected for a reading of zero to say anything."""
LEAST_TELLING = 8
"""Such readings needed."""
LIT = 40.0
"""counts below dark at which a light sensor must see the lamp."""
LEAST_LIT, LEAST_BLOCKS = 30, 3
"""Such moments needed, and blocks of time that they are in: an unseen obstacle may shade a robot
for a while."""
DARK_SHARE = 0.15
"""Of the light expected, most that a covered sensor reads."""
MOST = 0.5
"""Of the sensors that should have seen light, those that may be dead. Our choice: most sensors of
a log do not die at once."""
UNLIT = 2.0
"""counts expected of the lamp, below which only the room's light is seen."""
DARKER = 25.0
"""counts by which a covered sensor is darker than the others where they see the room alone."""
LEAST_NOISE = 60
"""Readings of at least `TELLING` counts from which a scale of noise is told."""
NORMAL = 1.4826
SQUARE = 0.7
"""Of a robot's radius within which a ray surely meets it."""


class Scale(NamedTuple):
    """Logarithm of the infrared errors' scale, and its standard error."""

    value: FloatArray
    """(robots,) NaN where too little was seen."""
    error: FloatArray


def dead_infrared(sight: Sight, expected: FloatArray, silent: float) -> Bools:
    """(robots, 8) sensors that read zero whatever is before them.

    Args:
        sight: The log's.
        expected: (rows, 16) counts.
        silent: Largest share of zeros of a healthy sensor.
    """
    dead = np.zeros((len(sight.robots), SENSORS), dtype=np.bool_)
    for k in range(len(sight.robots)):
        rows = sight.rows_of(k)
        read, told = sight.read[rows, :SENSORS], expected[rows, :SENSORS]
        known = np.isfinite(read)
        number = np.maximum(known.sum(axis=0), 1)
        loud = ((read != 0.0) & known).sum(axis=0) / number
        telling = (known & sight.free[rows, :SENSORS] & (told > TELLING)).sum(axis=0)
        seen = (telling >= LEAST_TELLING) | ((silent < 0.9) & (number > 200))
        dead[k] = known.any(axis=0) & (loud <= DEAD_SHARE) & seen
    return dead


def dead_light(sight: Sight, expected: FloatArray, model: PointModel) -> Bools:
    """(robots, 8) light sensors that read dark whatever light there is.

    Where most sensors do, it is not they: the lamp is elsewhere, or out.
    """
    assert model.tables is not None
    room = model.tables.ls_dark
    told_of = np.zeros((len(sight.robots), SENSORS), dtype=np.bool_)
    dead = np.zeros((len(sight.robots), SENSORS), dtype=np.bool_)
    for k in range(len(sight.robots)):
        rows = sight.rows_of(k)
        free = sight.free[rows, SENSORS:]
        below = room - sight.read[rows, SENSORS:]
        told = room - expected[rows, SENSORS:]
        for s in range(SENSORS):
            seen = free[:, s]
            lit = seen & (told[:, s] > LIT)
            blocks = len(np.unique(sight.block[rows][lit]))
            told_of[k, s] = lit.sum() >= LEAST_LIT and blocks >= LEAST_BLOCKS
            if not seen.any() or np.nanquantile(below[:, s], 0.99) >= 0.5 * LIT:
                continue  # it has seen light
            if told_of[k, s]:
                dead[k, s] = np.median(below[lit, s] / told[lit, s]) < DARK_SHARE
            else:
                unlit = free & (told < UNLIT)
                others = np.delete(np.arange(SENSORS), s)
                if unlit[:, s].sum() >= LEAST_LIT and unlit[:, others].any():
                    usual = float(np.median(below[:, others][unlit[:, others]]))
                    dead[k, s] = np.median(below[unlit[:, s], s]) < usual - DARKER
    if (dead & told_of).sum() > MOST * told_of.sum():
        dead &= ~told_of
    return dead


def noise_scale(sight: Sight, residual: FloatArray, expected: FloatArray, use: Bools) -> Scale:
    """Scale of each robot's infrared errors in units of the expected noise.

    Args:
        sight: The log's.
        residual: (rows, 16) errors in noise.
        expected: (rows, 16) counts of a healthy robot: the strong readings are judged.
        use: (rows, 16) which are judged.
    """
    value = np.full(len(sight.robots), np.nan)
    error = np.full(len(sight.robots), np.inf)
    for k in range(len(sight.robots)):
        rows = sight.rows_of(k)
        telling = use[rows, :SENSORS] & (expected[rows, :SENSORS] > TELLING)
        number = int(telling.sum())
        if number >= LEAST_NOISE:
            errors = residual[rows, :SENSORS][telling]
            value[k] = np.log(NORMAL * np.median(np.abs(errors - np.median(errors))))
            error[k] = 1.17 / np.sqrt(number)  # of a median absolute deviation's logarithm
    return Scale(value, error)


def of_robots(
    sight: Sight, model: PointModel, expected: FloatArray, use: Bools
) -> tuple[float, float]:
    """Logarithm of what infrared reads of other robots over a wall's reading there, and its error.

    NaN where no robot was surely in a sensor's ray.
    """
    tables = model.tables
    assert tables is not None
    ratios, blocks = [], []
    place, poses = sight.neighbours.place, sight.poses
    away = place - poses[:, None, :2]
    near = np.hypot(away[..., 0], away[..., 1]) < tables.ps_range + 2.0 * model.body_radius
    row, other = np.nonzero(near & (near.sum(axis=1) == 1)[:, None])
    x, y = away[row, other].T
    radius = model.body_radius
    for k, angle in enumerate(model.sensor_angles):
        c, s = np.cos(poses[row, 2] + angle), np.sin(poses[row, 2] + angle)
        ahead, aside = c * x + s * y, np.abs(c * y - s * x)
        deep = np.sqrt(np.maximum(radius**2 - aside**2, 0.0))
        distance = ahead - deep - radius
        sure = (ahead > 0.0) & (aside < SQUARE * radius) & (distance > 0.002)
        sure &= (distance < tables.ps_range) & use[row, k] & (expected[row, k] < 2.0)
        told = _looked_up(tables.ps_counts[k], distance / tables.ps_range, deep / radius)
        read = sight.read[row, k]
        sure &= np.isfinite(read) & (told > TELLING)
        ratios.append(read[sure] / told[sure])
        blocks.append(sight.block[row][sure])
    ratio, block = np.concatenate(ratios), np.concatenate(blocks)
    if len(ratio) < LEAST_NOISE:
        return float("nan"), float("inf")
    middle = float(np.median(ratio))
    wide = NORMAL * float(np.median(np.abs(ratio - middle)))
    pull = np.bincount(block, np.sign(ratio - middle))
    error = 1.2533 * wide * np.sqrt(float((pull**2).sum())) / len(ratio)
    return float(np.log(max(middle, 1e-3))), error / max(middle, 1e-3)


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

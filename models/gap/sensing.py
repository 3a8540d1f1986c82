"""What the sensors read against what the point model says they should.

Sensors are predicted where the tracker saw the robot. Its noise matters next to a wall, where a
millimetre is many counts, so the pose is first averaged over a third of a second, each carried to
the middle one by the replayed motion; and the prediction is the mean over what is left of the noise
(six sigma points), of readings clipped as the converter clips them.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS, PointModel, Tables, readings
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.replay import windows
from realitygap.models.log.frames import Windows, motion, moved, wrapped
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise
from realitygap.models.log.schema import CASES, LS, PS
from realitygap.models.log.tracker import NORMAL

AROUND = 0.16
"""s on each side over which poses are averaged at most: a replay hardly drifts in it."""
DRIFT = 1.5
"""Times the tracker's noise by which poses that a replay carries may scatter and still be averaged:
where a log misses commands, it carries them nowhere."""
SPACING = 0.4
"""s between the rows that are judged, at least: no pose measurement enters two of them."""
QUANTISATION = 1.0 / 12.0
"""counts^2, variance of rounding to whole counts."""


class Predicted(NamedTuple):
    """Predicted readings at some rows of a log."""

    mean: FloatArray
    """(rows, 16) counts, ps0..ps7 and ls0..ls7; NaN where nothing can be predicted."""
    noise: FloatArray
    """(rows, 16) counts, standard deviation of sensor noise and of the pose's uncertainty."""


def judged_rows(log: MeasuredLog) -> npt.NDArray[np.int64]:
    """Rows so far apart that their averaged poses share no measurement."""
    length = max(SPACING, (2 * _most_around(log) + 1) * log.step)
    return windows(log, length, apart=True).first


def _most_around(log: MeasuredLog) -> int:
    """Rows on each side that lie within `AROUND`."""
    return int(AROUND / log.step + 1e-9)


def rows_around(log: MeasuredLog, replayed: FloatArray, noise: PoseNoise) -> int:
    """Rows on each side over which poses can be averaged: as many as a replay carries well.

    Args:
        log: Measured.
        replayed: (rows, 3) its commands through the model.
        noise: Of its tracker.
    """
    rows = np.flatnonzero(log.tracked)
    usual = np.sqrt(2.0) * noise.position
    for half in range(1, _most_around(log) + 1):
        for offset in (-half, half):
            difference, ok = _carried(log, replayed, rows, offset)
            off = difference[ok, :2]
            if len(off) and NORMAL * np.median(np.abs(off)) > DRIFT * usual:
                return half - 1
    return _most_around(log)


def averaged_poses(
    log: MeasuredLog, replayed: FloatArray, rows: npt.NDArray[np.int64], half: int
) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    """(rows, 3) poses averaged over `half` rows on each side, and how many measurements each is
    made of."""
    total = np.zeros((len(rows), 3))
    count = np.zeros(len(rows), dtype=np.int64)
    for offset in range(-half, half + 1):
        difference, ok = _carried(log, replayed, rows, offset)
        total += np.where(ok[:, None], difference, 0.0)
        count += ok
    return log.poses[rows] + total / np.maximum(count, 1)[:, None], count


def _carried(
    log: MeasuredLog, replayed: FloatArray, rows: npt.NDArray[np.int64], offset: int
) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """(rows, 3) poses some rows away, moved there by the replay, less those there; and whether
    both were measured."""
    poses = log.poses
    other = np.clip(rows + offset, 0, len(log.t) - 1)
    ok = (log.stretch[other] == log.stretch[rows]) & log.tracked[other]
    pairs = Windows(other, rows)
    difference = moved(poses[pairs.first], motion(replayed, pairs)) - poses[rows]
    difference[:, 2] = wrapped(difference[:, 2])
    return difference, ok


def predict(
    log: MeasuredLog,
    model: PointModel,
    poses: FloatArray,
    count: npt.NDArray[np.int64],
    rows: npt.NDArray[np.int64],
    noise: PoseNoise,
    own: Mapping[int, PointModel] = MappingProxyType({}),
) -> Predicted:
    """Readings expected at poses (rows, 3), each averaged over `count` measurements.

    The model must have sensor tables; `own` are models of single robots, by id.
    """
    tables = model.tables
    assert tables is not None
    scenario = scenarios(log)[rows]
    known = scenario >= 0
    means, squares, variances = (np.zeros((len(rows), 2 * SENSORS)) for _ in range(3))
    lit = np.where(known, scenario, 1).astype(np.int32)
    time = (log.t - log.t[log.start[:-1]][log.segment])[rows]
    robot = log.frame["robot"].to_numpy(dtype=np.int64)[rows]
    spread = np.array([noise.position, noise.position, noise.heading])
    shrunk = spread / np.sqrt(np.maximum(count, 1))[:, None]
    for axis in range(3):
        for sign in (-1.0, 1.0):
            point = poses.copy()
            point[:, axis] += sign * np.sqrt(3.0) * shrunk[:, axis]
            mean, variance = _expected(point, lit, time, model)
            for one, its in own.items():
                mine = robot == one
                mean[mine], variance[mine] = _expected(point[mine], lit[mine], time[mine], its)
            means += mean / 6
            squares += mean**2 / 6
            variances += variance / 6
    variance = variances + np.maximum(squares - means**2, 0.0) + QUANTISATION
    means[~known, SENSORS:] = np.nan
    return Predicted(means, np.sqrt(variance))


def measured(log: MeasuredLog, rows: npt.NDArray[np.int64]) -> FloatArray:
    """(rows, 16) counts as logged; NaN where not logged."""
    result = np.full((len(rows), 2 * SENSORS), np.nan)
    for k, name in enumerate((*PS, *LS)):
        if name in log.frame:
            result[:, k] = log.frame[name].to_numpy(dtype=float)[rows]
    return result


def scenarios(log: MeasuredLog) -> npt.NDArray[np.int32]:
    """(rows,) light scenario, -1 where the log does not say."""
    if "case" not in log.frame:
        return np.full(len(log.t), -1, dtype=np.int32)
    index = log.frame["case"].map(CASES).fillna(-1)
    return np.ascontiguousarray(index.to_numpy(), dtype=np.int32)


def _expected(
    poses: FloatArray, scenario: npt.NDArray[np.int32], time: FloatArray, model: PointModel
) -> tuple[FloatArray, FloatArray]:
    """(rows, 16) mean and variance of one model's readings."""
    assert model.tables is not None
    read = readings(poses, scenario, time, model=model)
    return _clipped(np.hstack([read.ps, read.ls]), model.tables, model.senses.ps_noise)


def _clipped(
    reading: FloatArray, tables: Tables, louder: float = 1.0
) -> tuple[FloatArray, FloatArray]:
    """Mean and variance of readings (n, 16) with the tables' uniform noise, clipped by the
    converter.

    Of a uniform variable on [m - a, m + a] clipped to [0, top], by integration; `louder` times the
    tables' noise of infrared.
    """
    top = tables.counts_max
    width = np.empty_like(reading)
    usual = tables.ps_noise * reading[:, :SENSORS] + tables.ps_noise_floor
    width[:, :SENSORS] = louder * usual
    width[:, SENSORS:] = tables.ls_noise
    width = np.maximum(width, 1e-9)
    low, high = np.clip(reading - width, 0, top), np.clip(reading + width, 0, top)
    above = np.clip(reading + width - top, 0, 2 * width)
    mean = ((high**2 - low**2) / 2 + above * top) / (2 * width)
    square = ((high**3 - low**3) / 3 + above * top**2) / (2 * width)
    return mean, np.maximum(square - mean**2, 0.0)

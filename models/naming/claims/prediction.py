"""How far models are off in a log: motion by horizon, infrared, light, the nest.

Every model is asked the same: windows and readings are chosen by the first one and by the
measurements, never by what a model gets right. Errors are absolute; sums and numbers are kept, by
robot, by stretch of time and by stratum, so that means can be taken and resampled over any of them.
Strata are like situations: how much the command changed, how much of wall or lamp is to be seen.
Robots are compared in like situations, for one that turns more is off more.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import SENSORS, PointModel, Tables
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief
from realitygap.models.gap.believed import replay_believed
from realitygap.models.gap.conditions import conditions, never_touching
from realitygap.models.gap.motion_gap import CLEAR_TO, throughout
from realitygap.models.gap.replay import HORIZONS, errors, windows
from realitygap.models.gap.sensor_gap import sensors_to_judge
from realitygap.models.gap.stood import poses_as_stood
from realitygap.models.log.blocks import BLOCK_SECONDS
from realitygap.models.log.frames import Windows
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.channels.senses.nest import answers
from realitygap.models.naming.channels.senses.predicted import noise, noise_scale, predict
from realitygap.models.naming.channels.senses.sight import Sight, look

SEEN = 20.0
"""counts that the first model must expect for an infrared reading to be judged: the wall is there.
Our choice: four times the noise of a reading of nothing. No rule, as all numbers here: they say
where a gap is measured, not what is named."""
MOST_ROWS = 6000
"""Rows of a run whose sensors are judged: five a second of ten robots in two minutes."""
CHANGES = (0.5, 3.0, 6.0, 10.0, 15.0, 25.0)
"""rad/s that the commands change by within a second, or from a little before a shorter window, that
divide strata of motion: nothing, search's curves, one turn, several. Our choice."""
LAST_ROWS = 3
"""Rows before a window whose commands the motors may still be following."""
COUNTS = {"ps": (50.0, 100.0, 200.0, 400.0, 800.0, 1600.0), "ls": (5.0, 50.0, 150.0, 400.0, 1000.0)}
"""counts that the first model expects (light: below dark) that divide strata of readings."""
COLUMNS = (
    "model",
    "kind",
    "channel",
    "horizon",
    "unit",
    "robot",
    "block",
    "stratum",
    "total",
    "number",
)
MOTION = {"position": "m", "heading": "rad"}
"""Channels of motion and their units."""
STRATA = 1 + max(len(edges) for edges in (CHANGES, *COUNTS.values()))
Counts = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


def judged_windows(log: MeasuredLog, free: Bools, length: float) -> Windows:
    """Windows of a length (s; 0: one row) from every row, clear of contact where windows are short
    enough for any to be.

    Args:
        log: Measured.
        free: (rows,) clear of contact as far as is known.
        length: s.
    """
    pairs = windows(log, length)
    if length > CLEAR_TO or not len(pairs.first):
        return pairs
    kept = throughout(free, pairs)
    return Windows(pairs.first[kept], pairs.last[kept])


def off(measured: FloatArray, replayed: FloatArray, pairs: Windows) -> FloatArray:
    """(windows, 2) how far a prediction is off at each window's end, as in `MOTION`.

    Args:
        measured: (rows, 3).
        replayed: (rows, 3) of a model.
        pairs: The windows.
    """
    error = errors(measured, replayed, pairs)
    return np.column_stack([np.hypot(error[:, 0], error[:, 1]), np.abs(error[:, 2])])


class _Cells(NamedTuple):
    """Robots times blocks of time."""

    robots: tuple[int, ...]
    blocks: int

    def sums(
        self, robot: Counts, time: FloatArray, stratum: Counts, error: FloatArray
    ) -> pd.DataFrame:
        """Sum and number of errors in each cell and stratum; (n,) each, `robot` an index."""
        known = np.isfinite(error)
        shape = (len(self.robots), self.blocks, STRATA)
        block = (time / BLOCK_SECONDS).astype(np.int64)
        cell = np.ravel_multi_index((robot[known], block[known], stratum[known]), shape)
        number = np.bincount(cell, minlength=int(np.prod(shape)))
        total = np.bincount(cell, error[known], len(number))
        some = np.flatnonzero(number)
        who, when, which = np.unravel_index(some, shape)
        return pd.DataFrame(
            {
                "robot": np.array(self.robots)[who],
                "block": when,
                "stratum": which,
                "total": total[some],
                "number": number[some],
            }
        )


def prediction_errors(
    log: MeasuredLog, models: Mapping[str, ModelFile], tables: Tables | None
) -> pd.DataFrame:
    """Absolute errors of several models in one run.

    Args:
        log: Measured, of one run.
        models: By name; the first says what is judged, and none of the places differs.
        tables: Captured; None: motion alone.

    Returns:
        A row per model, kind (motion, ps, ls, noise, nest), channel, horizon (motion), robot and
        block of `BLOCK_SECONDS` and stratum: `total` of the absolute errors in `unit` and their
        `number`.
    """
    robots = np.unique(log.frame["robot"].to_numpy(dtype=np.int64))
    since = log.t - log.t[log.start[:-1]][log.segment]
    cells = _Cells(tuple(robots.tolist()), int(since.max() / BLOCK_SECONDS) + 1)
    believed = {
        name: {robot: file.motion(robot) for robot in cells.robots} for name, file in models.items()
    }
    plain = next(iter(models.values()))
    parts = _motion(log, plain, believed, cells, since)
    point = plain.point_model(tables)
    kinds = sensors_to_judge(log, point)
    if kinds:
        parts += _senses(log, models, believed, point, kinds, cells)
    if plain.arena is not None:
        parts += _nest(log, models, believed, point, cells, since)
    table = pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=COLUMNS)
    return table[list(COLUMNS)]


def _motion(
    log: MeasuredLog,
    plain: ModelFile,
    believed: Mapping[str, Mapping[int, Motion]],
    cells: _Cells,
    since: FloatArray,
) -> list[pd.DataFrame]:
    """Position (m) and heading (rad) at the end of windows from every row, clear of contact where
    windows are short enough for any to be."""
    robot = np.searchsorted(cells.robots, log.frame["robot"].to_numpy(dtype=np.int64))
    table = conditions(log, plain)
    free = never_touching(table, log.tracked)
    changed = np.cumsum(table["change"].to_numpy())
    replayed = {name: replay_believed(log, motions) for name, motions in believed.items()}
    parts = []
    for horizon, length in HORIZONS.items():
        pairs = judged_windows(log, free, length)
        if not len(pairs.first):
            continue
        before = np.maximum(pairs.first - LAST_ROWS, log.start[:-1][log.segment[pairs.first]])
        much = (changed[pairs.last] - changed[before]) / max(length, 1.0)
        stratum = np.searchsorted(CHANGES, much)
        for name, poses in replayed.items():
            sizes = dict(zip(MOTION.items(), off(log.poses, poses, pairs).T, strict=True))
            for (channel, unit), size in sizes.items():
                sums = cells.sums(robot[pairs.first], since[pairs.first], stratum, size)
                labels = {"model": name, "kind": "motion", "channel": channel}
                parts.append(sums.assign(**labels, horizon=horizon, unit=unit))
    return parts


def _senses(
    log: MeasuredLog,
    models: Mapping[str, ModelFile],
    believed: Mapping[str, Mapping[int, Motion]],
    point: PointModel,
    kinds: list[str],
    cells: _Cells,
) -> list[pd.DataFrame]:
    """Infrared and light (counts) sensor by sensor, and how wrong the infrared's noise is."""
    plain = look(log, point, most=MOST_ROWS)
    none = [Belief(senses=point.senses)] * len(plain.robots)
    expected = predict(plain, point, none)
    use = plain.free & np.isfinite(plain.read)
    judged = judged_readings(use, expected)
    assert point.tables is not None
    strata = {
        "ps": np.searchsorted(COUNTS["ps"], expected[:, :SENSORS]),
        "ls": np.searchsorted(COUNTS["ls"], point.tables.ls_dark - expected[:, SENSORS:]),
    }
    parts = []
    for name, file in models.items():
        seen = _askew(believed[name])
        moved = {r: m for r, m in believed[name].items() if m != Motion(drive=point.drive)}
        sight = look(log, point, seen, moved=moved, most=MOST_ROWS) if moved else plain
        beliefs = [_belief(file, robot) for robot in sight.robots]
        counts = predict(sight, point, beliefs)
        error = np.abs(sight.read - counts)
        halves = {"ps": error[:, :SENSORS], "ls": error[:, SENSORS:]}
        for kind in kinds:
            for k, channel in enumerate(PS if kind == "ps" else LS):
                some = judged[kind][:, k]
                stratum, size = strata[kind][some, k], halves[kind][some, k]
                sums = cells.sums(sight.robot[some], sight.time[some], stratum, size)
                labels = {"model": name, "kind": kind, "channel": channel}
                parts.append(sums.assign(**labels, horizon="", unit="counts"))
        if "ps" in kinds:
            parts.append(_noise(sight, point, beliefs, counts, use, name))
    return parts


def judged_readings(use: Bools, expected: FloatArray) -> dict[str, Bools]:
    """(rows, 8) by kind: readings that are judged.

    Args:
        use: (rows, 16) readings that nothing but wall and lamp can have caused.
        expected: (rows, 16) counts of the first model.
    """
    return {
        "ps": use[:, :SENSORS] & (expected[:, :SENSORS] > SEEN),
        "ls": use[:, SENSORS:],
    }


def _noise(
    sight: Sight,
    point: PointModel,
    beliefs: list[Belief],
    counts: FloatArray,
    use: Bools,
    name: str,
) -> pd.DataFrame:
    """One number per robot: size of the logarithm of the infrared's noise over the expected."""
    residual = np.where(use, (sight.read - counts) / noise(sight, point, beliefs, counts), 0.0)
    wrong = np.abs(noise_scale(sight, residual, counts, use))
    frame = pd.DataFrame(
        {"robot": sight.robots, "block": 0, "stratum": 0, "total": wrong, "number": 1}
    )
    labels = {"model": name, "kind": "noise", "channel": "infrared noise"}
    return frame[np.isfinite(wrong)].assign(**labels, horizon="", unit="log ratio")


def _nest(
    log: MeasuredLog,
    models: Mapping[str, ModelFile],
    believed: Mapping[str, Mapping[int, Motion]],
    point: PointModel,
    cells: _Cells,
    since: FloatArray,
) -> list[pd.DataFrame]:
    """Share of the virtual sensor's answers about the nest that are predicted wrongly."""
    seen = answers(log)
    if seen is None:
        return []
    rows = seen.rows
    robot = np.searchsorted(cells.robots, seen.robot)
    parts = []
    for name, file in models.items():
        poses = poses_as_stood(log, point, rows, log.poses[rows], _askew(believed[name]))
        wrong = np.zeros(len(rows))
        for k, one in enumerate(cells.robots):
            mine = robot == k
            x, y, radius = _belief(file, one).of(point).nest
            inside = np.hypot(poses[mine, 0] - x, poses[mine, 1] - y) < radius
            wrong[mine] = inside != seen.inside[mine]
        labels = {"model": name, "kind": "nest", "channel": "nest"}
        sums = cells.sums(robot, since[rows], np.zeros(len(rows), dtype=np.int64), wrong)
        parts.append(sums.assign(**labels, horizon="", unit="share"))
    return parts


def _belief(file: ModelFile, robot: int) -> Belief:
    """What a model file has one robot believe of its senses."""
    return Belief() if file.extension is None else file.extension.sensed(robot)


def _askew(believed: Mapping[int, Motion]) -> dict[int, tuple[Motion, Motion]]:
    """Robots whose marker or tracker's clock is believed off: without that, and with it."""
    return {
        robot: (replace(motion, lever=(0.0, 0.0), yaw_offset=0.0, pose_delay=0.0), motion)
        for robot, motion in believed.items()
        if any((*motion.lever, motion.yaw_offset, motion.pose_delay))
    }

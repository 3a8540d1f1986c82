"""What is to be seen of a log, in frames that come at an even rate, run by run.

What robots believed of the lamp while they were recorded comes out of their runs' files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.believed import motions, replay_believed
from realitygap.models.gap.sensing import measured as sensed
from realitygap.models.gap.sensing import scenarios
from realitygap.models.log.frames import Rows, Windows, motion, moved
from realitygap.models.log.measured import GAP_STEPS, MeasuredLog
from realitygap.models.log.schema import PS, VIRTUAL
from realitygap.studies.fitness_gap.generations import find_generations, read_generations
from realitygap.studies.inputs.logs import Log
from realitygap.studies.replay.sight import brightness, rays


class Believed(NamedTuple):
    """One robot's S0 in one generation."""

    begin: float
    """s, as in the log."""
    end: float
    third: int
    """0: the lamp opposite the nest, 1: none, 2: at the nest."""
    s0: float
    """NaN: not told."""


Beliefs: TypeAlias = Mapping[str, Sequence[Believed]]
"""By robot, in order of time."""


def beliefs_of(log: Log) -> dict[str, dict[str, list[Believed]]]:
    """By run and robot; empty for logs that are not the directories of runs.

    Raises:
        InputError: a directory's table of generations cannot be used.
    """
    found: dict[str, dict[str, list[Believed]]] = {}
    for k, source in enumerate(log.sources):
        path = None if source.path is None else find_generations(source.path)
        if path is None:
            continue
        table = read_generations(path).dropna(subset=["t_start", "t_end", "s0_third"])
        prefix = f"{k + 1}/" if len(log.sources) > 1 else ""
        table = table.sort_values("t_start")
        s0 = pd.to_numeric(table.get("s0", np.nan), errors="coerce")
        table = table.assign(s0=np.asarray(s0, dtype=float))
        names = (prefix + table["run"], table["robot"].astype(str))
        numbers = (table[name].tolist() for name in ("t_start", "t_end", "s0_third", "s0"))
        for run, robot, begin, end, third, value in zip(*names, *numbers, strict=True):
            of_robot = found.setdefault(run, {}).setdefault(robot, [])
            of_robot.append(Believed(begin, end, int(third), value))
    return found


FRAME = 0.04
"""s between frames at least; our choice: the control step, as smooth as a screen needs."""
CELLS = 180_000
"""Frames times robots at most. Our choice: a page of ten robots in ten minutes at the control
step has 150 000 and stays below 5 MB; a longer log has fewer frames a second."""
HOLE = 1.0
"""s without a pose that are bridged by a straight line; our choice."""
NEAR = 1e-3
"""Share of a frame by which written times may miss it: rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """One run: robots, frames and what is known of each; lengths in m, angles in rad."""

    run: str
    begin: float
    """s, time of the first frame in the log."""
    step: float
    """s between frames."""
    robots: tuple[str, ...]
    poses: FloatArray
    """(robots, frames, 3); NaN where the tracker lost the robot."""
    ghosts: FloatArray
    """(robots, frames, 3) where the model says it should be; NaN where it says nothing."""
    carries: npt.NDArray[np.bool_] | None
    """(robots, frames) food; None: the log does not tell."""
    rays: FloatArray | None
    """(robots, frames, 8) m from the body to what infrared seems to see; NaN: nothing. None: the
    log has no infrared."""
    light: FloatArray | None
    """(robots, frames, 8) from 0 dark to 1; None: the log has no light that the model can read."""
    lamp: npt.NDArray[np.int8]
    """(frames,) index into the model's lamps; -1: unknown."""
    beliefs: Beliefs
    """What each robot's simulator believed of the lamp, and when."""

    @property
    def times(self) -> FloatArray:
        """(frames,) s since the first."""
        return np.arange(self.poses.shape[1], dtype=np.float64) * self.step


def scenes(log: Log, restart: float) -> tuple[Scene, ...]:
    """Every run of a log.

    Args:
        log: With the model that the ghosts follow.
        restart: s after which a ghost begins anew at the measured pose.

    Raises:
        InputError: the model's extension concerns a robot that the log does not have.
        Diverged: the replay left the finite numbers.
    """
    measured, point = log.measured, log.model.point()
    replayed = replay_believed(measured, motions(measured, log.model.file, log.model.label))
    anchors = _anchors(measured, restart)
    step, names = _step(measured), measured.segments["run"].astype(str).to_numpy()
    known = beliefs_of(log)
    return tuple(
        _scene(measured, point, replayed, anchors, step, run, known.get(run, {}))
        for run in dict.fromkeys(names.tolist())
    )


def _step(log: MeasuredLog) -> float:
    """s between frames: the log's, but no shorter than a screen needs and a page can hold."""
    t, start, runs = log.t, log.start, log.segments["run"]
    begin, end = (pd.Series(t[rows]).groupby(runs) for rows in (start[:-1], start[1:] - 1))
    cells = float(((end.max() - begin.min()) * end.count()).sum())
    return max(log.step, FRAME, cells / CELLS)


def _anchors(log: MeasuredLog, restart: float) -> Rows:
    """(rows,) the tracked row at which each row's prediction begins; -1: there is none yet."""
    tracked = np.flatnonzero(log.tracked)
    stretch, t = log.stretch[tracked], log.t[tracked]
    new = np.diff(stretch, prepend=-1) != 0
    first = t[np.maximum.accumulate(np.where(new, np.arange(len(t)), 0))]
    cell = np.floor((t - first) / restart + NEAR)
    begins = new | (np.diff(cell, prepend=-1.0) != 0)
    marked = np.full(len(log.t), -1, dtype=np.int64)
    marked[tracked[begins]] = tracked[begins]
    last: Rows = np.maximum.accumulate(marked)
    last[(last >= 0) & (log.stretch[last] != log.stretch)] = -1
    return last


def _scene(
    log: MeasuredLog,
    point: PointModel,
    replayed: FloatArray,
    anchors: Rows,
    step: float,
    run: str,
    beliefs: Beliefs,
) -> Scene:
    mine = np.flatnonzero(log.segments["run"].astype(str).to_numpy() == run)
    pieces = [slice(int(log.start[k]), int(log.start[k + 1])) for k in mine]
    t = log.t
    begin = min(t[piece.start] for piece in pieces)
    end = max(t[piece.stop - 1] for piece in pieces)
    at = begin + step * np.arange(int((end - begin) / step + NEAR) + 1)
    shape = (len(pieces), len(at))
    poses, ghosts = np.full((*shape, 3), np.nan), np.full((*shape, 3), np.nan)
    rows = np.full(shape, -1, dtype=np.int64)
    for k, piece in enumerate(pieces):
        rows[k] = _rows(log, piece, at, step)
        poses[k] = _poses(log, piece, at, step)
        ghosts[k] = _ghosts(log, piece, at, replayed, anchors, rows[k])
    seen = sensed(log, np.maximum(rows, 0).ravel()).reshape(*shape, 2 * SENSORS)
    seen[rows < 0] = np.nan
    has_ps = any(name in log.frame for name in PS)
    lamps = np.where(rows >= 0, scenarios(log)[np.maximum(rows, 0)], -1)
    return Scene(
        run=run,
        begin=float(begin),
        step=step,
        robots=tuple(log.names[int(robot)] for robot in log.segments["robot"].iloc[mine]),
        poses=poses,
        ghosts=ghosts,
        carries=_carries(log, rows),
        rays=rays(seen[..., :SENSORS], point) if has_ps else None,
        light=brightness(seen[..., SENSORS:], point),
        lamp=lamps.max(axis=0).astype(np.int8),
        beliefs=beliefs,
    )


def _rows(log: MeasuredLog, piece: slice, at: FloatArray, step: float) -> Rows:
    """(frames,) the latest row at each frame; -1: none, or too long ago."""
    t = log.t[piece]
    row = np.searchsorted(t, at + NEAR * step, side="right") - 1
    gone = (row < 0) | (at - t[row] > GAP_STEPS * max(log.step, step))
    return np.where(gone, -1, row + piece.start)


def _poses(log: MeasuredLog, piece: slice, at: FloatArray, step: float) -> FloatArray:
    """(frames, 3) measured, on a straight line between two measurements; NaN where lost."""
    found = np.full((len(at), 3), np.nan)
    rows = np.flatnonzero(log.tracked[piece]) + piece.start
    if not len(rows):
        return found
    t, poses = log.t[rows], log.poses[rows]
    poses[:, 2] = np.unwrap(poses[:, 2])
    before = np.searchsorted(t, at + NEAR * step, side="right") - 1
    after = np.minimum(before + 1, len(rows) - 1)
    one = log.stretch[rows[before]] == log.stretch[rows[after]]
    between = one & (t[after] - t[before] <= HOLE) & (at <= t[-1] + NEAR * step)
    there = (before >= 0) & (between | (np.abs(at - t[before]) < 0.5 * step))
    for k in range(3):
        found[there, k] = np.interp(at[there], t, poses[:, k])
    return found


def _ghosts(
    log: MeasuredLog,
    piece: slice,
    at: FloatArray,
    replayed: FloatArray,
    anchors: Rows,
    rows: Rows,
) -> FloatArray:
    """(frames, 3) the pose measured at each frame's anchor, moved on by the replay; NaN: none."""
    found = np.full((len(at), 3), np.nan)
    there = np.flatnonzero(rows >= 0)
    there = there[anchors[rows[there]] >= 0]
    anchor, path = anchors[rows[there]], replayed[piece].copy()
    path[:, 2] = np.unwrap(path[:, 2])
    now = np.column_stack([np.interp(at[there], log.t[piece], path[:, k]) for k in range(3)])
    both = np.vstack([replayed[anchor], now])
    n = np.arange(len(there))
    found[there] = moved(log.poses[anchor], motion(both, Windows(n, n + len(there))))
    return found


def _carries(log: MeasuredLog, rows: Rows) -> npt.NDArray[np.bool_] | None:
    """(robots, frames) whether a robot has found food that it has not yet brought to the nest."""
    if not set(VIRTUAL) <= set(log.frame):
        return None
    food, nest = (log.frame[name].fillna(False).to_numpy(dtype=bool) for name in VIRTUAL)
    begins = np.zeros(len(food), dtype=bool)
    begins[log.start[:-1]] = True
    food[:-1] &= ~food[1:] | begins[1:]  # what is taken is no longer there in the next row
    told = np.flatnonzero(food | nest | begins)
    carries = np.zeros(len(told), dtype=bool)
    carrying = False
    for k, row in enumerate(told.tolist()):
        carrying = not nest[row] if carrying and not begins[row] else bool(food[row])
        carries[k] = carrying
    last = np.searchsorted(told, np.maximum(rows, 0), side="right") - 1
    return np.asarray(carries[last] & (rows >= 0))

"""How far model files are off 1, 5 and 20 s ahead, in parts of a log that they were not fitted to.

A model file may be one for each part of the log: a window lies in one part, and is predicted by
that part's file. Errors are those of `claims.prediction`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import replay_segments
from realitygap.models.gap.conditions import never_touching
from realitygap.models.gap.motion_gap import throughout
from realitygap.models.gap.replay import HORIZONS, errors
from realitygap.models.log.blocks import BLOCK_SECONDS, nth
from realitygap.models.log.frames import Rows, Windows
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise, window_noise
from realitygap.models.naming.claims.prediction import MOTION, judged_windows, off

SECONDS = ("1 s", "5 s", "20 s")
"""Horizons at which a prediction is judged, of `HORIZONS`."""
MOST_WINDOWS = 60_000
"""Windows of a log judged at each horizon, evenly over it: more sharpen nothing. No rule: it
bounds the work."""

Motions = Callable[[int, int], Motion]
"""(robot, part of the log that is judged) -> its motion."""


def key(channel: str, horizon: str) -> str:
    """Of `gain` in `diagnosis.json`: `position_1s`."""
    return f"{channel}_{horizon.replace(' ', '')}"


KEYS = {key(channel, horizon): unit for channel, unit in MOTION.items() for horizon in SECONDS}
"""Every one, with its unit."""
HORIZON_OF = {key(channel, horizon): horizon for channel in MOTION for horizon in SECONDS}


class _Look(NamedTuple):
    """One horizon."""

    pairs: Windows
    """Sorted by robot."""
    edge: Rows
    """(robots + 1,) first window of each robot, and the window count."""
    block: Rows
    """(windows,) block of time, counted over the log."""


class Ahead:
    """The windows of a log that are judged."""

    def __init__(self, log: MeasuredLog, table: pd.DataFrame) -> None:
        """Choose them; `table` are the log's `conditions`."""
        self.log, self.part = log, parts(log)
        self.segment_robot = log.segments["robot"].to_numpy(dtype=np.int64)
        self.robots = np.unique(self.segment_robot)
        self._measured = log.poses
        self._free = never_touching(table, log.tracked)
        self._looks = {horizon: self._look(HORIZONS[horizon]) for horizon in SECONDS}

    def _look(self, length: float) -> _Look:
        pairs = judged_windows(self.log, self._free, length)
        inside = self.part[pairs.first] == self.part[pairs.last]
        some = np.flatnonzero(inside)
        some = some[:: max(1, -(-len(some) // MOST_WINDOWS))]
        who = np.searchsorted(self.robots, self.segment_robot[self.log.segment[pairs.first[some]]])
        order = some[np.argsort(who, kind="stable")]
        first, last = pairs.first[order], pairs.last[order]
        long = max(BLOCK_SECONDS, length + 2.0 * self.log.step)
        segment = self.log.segment[first]
        since = self.log.t[first] - self.log.t[self.log.start[:-1]][segment]
        place = np.column_stack([segment, self.part[first], nth(since, long)])
        block = np.unique(place, axis=0, return_inverse=True)[1].reshape(-1)
        edge = np.searchsorted(np.sort(who), np.arange(len(self.robots) + 1))
        return _Look(Windows(first, last), edge, block)

    def _mine(self, look: _Look, robot: int) -> slice:
        k = int(np.searchsorted(self.robots, robot))
        return slice(int(look.edge[k]), int(look.edge[k + 1]))

    def windows(self, horizon: str, robot: int) -> Windows:
        """One robot's at one of `SECONDS`."""
        look = self._looks[horizon]
        mine = self._mine(look, robot)
        return Windows(look.pairs.first[mine], look.pairs.last[mine])

    def block(self, name: str, robots: Iterable[int]) -> Rows:
        """(windows,) block of every window of some robots, in their order."""
        look = self._looks[HORIZON_OF[name]]
        found = [look.block[self._mine(look, robot)] for robot in robots]
        return np.concatenate([np.zeros(0, dtype=np.int64), *found])

    def replay(self, robot: int, motions: Motions) -> FloatArray:
        """(rows, 3) where one robot should have been seen; NaN in the rows of others."""
        poses = np.full((len(self.log.t), 3), np.nan)
        mine = np.flatnonzero(self.segment_robot == robot).tolist()
        first, second = (motions(robot, part) for part in (0, 1))
        rows, seen = replay_segments(self.log, mine, first)
        if second != first:
            other = replay_segments(self.log, mine, second)[1]
            seen = np.where((self.part[rows] == 1)[:, None], other, seen)
        poses[rows] = seen
        return poses

    def sizes(self, robot: int, poses: FloatArray) -> dict[str, FloatArray]:
        """By key, (windows,) how far a robot's prediction is off."""
        return self._sizes(robot, lambda pairs: off(self._measured, poses, pairs))

    def sound(
        self,
        robot: int,
        minimal: FloatArray,
        healthy: FloatArray,
        noise: PoseNoise,
        rng: np.random.Generator,
    ) -> dict[str, FloatArray]:
        """By key, (windows,) how far the minimal model would be off of a healthy robot.

        Args:
            robot: Whose commands.
            minimal: (rows, 3) replayed by the minimal model.
            healthy: (rows, 3) by what healthy robots do, which is taken for the truth.
            noise: Of the tracker, drawn anew.
            rng: Draws it.
        """

        def sizes(pairs: Windows) -> FloatArray:
            error = errors(healthy, minimal, pairs)
            error += window_noise(healthy, pairs, noise) * rng.normal(size=error.shape)
            return np.column_stack([np.hypot(error[:, 0], error[:, 1]), np.abs(error[:, 2])])

        return self._sizes(robot, sizes)

    def _sizes(self, robot: int, sizes: Callable[[Windows], FloatArray]) -> dict[str, FloatArray]:
        found = {}
        for horizon, look in self._looks.items():
            mine = self._mine(look, robot)
            both = sizes(Windows(look.pairs.first[mine], look.pairs.last[mine]))
            for column, channel in enumerate(MOTION):
                found[key(channel, horizon)] = both[:, column]
        return found

    def apart(self, name: str, robot: int) -> Rows:
        """(n,) which of a robot's windows, in order, meet neither wall nor robot, and share no
        moment with one another."""
        look = self._looks[HORIZON_OF[name]]
        mine = self._mine(look, robot)
        pairs = Windows(look.pairs.first[mine], look.pairs.last[mine])
        chosen, free_from = [], -1
        for k in np.flatnonzero(throughout(self._free, pairs)).tolist():
            if pairs.first[k] > free_from:
                chosen.append(k)
                free_from = int(pairs.last[k])
        return np.array(chosen, dtype=np.int64)


def together(sizes: Sequence[dict[str, FloatArray]], name: str) -> FloatArray:
    """(windows,) of one key, of several robots one after the other."""
    return np.concatenate([np.zeros(0), *(one[name] for one in sizes)])

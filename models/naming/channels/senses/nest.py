"""What the virtual sensor said of the nest, and where robots crossed its edge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.log.blocks import BLOCK_SECONDS
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.naming.channels.senses.sight import Rows

SURELY_SEEN = 1e-4
"""m: least error of where a robot crossed the nest's edge. No rule: it keeps a ratio finite."""


class Answers(NamedTuple):
    """The virtual sensor's answers."""

    place: FloatArray
    """(rows, 2) m as measured."""
    inside: npt.NDArray[np.bool_]
    block: Rows
    """(rows,) of time, counted through."""
    robot: Rows
    """(rows,) ids."""
    rows: Rows
    """(rows,) of the log."""
    run: Rows
    """(rows,) the stretch of one robot's rows in one run."""
    time: FloatArray
    """(rows,) s since the run began."""


def answers(log: MeasuredLog) -> Answers | None:
    """The log's answers; None where it has none."""
    if "nest" not in log.frame:
        return None
    told = log.frame["nest"].astype("Float64").to_numpy(dtype=float, na_value=np.nan)
    rows = np.flatnonzero(log.tracked & np.isfinite(told))
    if not len(rows):
        return None
    time = log.t - log.t[log.start[:-1]][log.segment]
    key = log.segment * 10**6 + (time / BLOCK_SECONDS).astype(np.int64)
    return Answers(
        np.ascontiguousarray(log.poses[rows, :2]),
        told[rows] > 0.5,
        np.unique(key[rows], return_inverse=True)[1],
        log.frame["robot"].to_numpy(dtype=np.int64)[rows],
        rows,
        log.segment[rows],
        time[rows],
    )


class Crossings:
    """Where one robot crossed the nest's edge: between two poses, in one of which it said nest.

    Rows of the mixed model: how deep in the nest the edge was. Where it is, the depth is 0.
    """

    name, kinds = "nest", ("nest",)

    def __init__(self, seen: Answers, robot: int, model: PointModel, noise: float = 0.0) -> None:
        """Prepare.

        Args:
            seen: The log's answers.
            robot: Id.
            model: Whose nest.
            noise: m, of the tracker's positions.
        """
        mine = seen.robot == robot
        pair = mine[:-1] & mine[1:] & (np.diff(seen.rows) == 1) & (np.diff(seen.run) == 0)
        at = np.flatnonzero(pair & (seen.inside[:-1] != seen.inside[1:]))
        self._model, self._ends = model, (seen.place[at], seen.place[at + 1])
        self.rows, self.run, self.time = seen.rows[at], seen.run[at], seen.time[at]
        self.window = self.first = np.arange(len(at))
        deep = [self._depth(end, Belief()) for end in self._ends]
        wide = np.abs(deep[0] - deep[1]) / np.sqrt(12.0)  # anywhere between the two
        self.sd = np.maximum(np.hypot(wide, noise), SURELY_SEEN)

    def _depth(self, place: FloatArray, belief: Belief) -> FloatArray:
        x, y, radius = belief.of(self._model).nest
        return np.asarray(radius - np.hypot(place[:, 0] - x, place[:, 1] - y))

    def errors(self, belief: Belief) -> FloatArray:
        """(n,) in noise."""
        middle = sum(self._depth(end, belief) for end in self._ends) / 2.0
        return np.asarray(-middle / self.sd)

    def bearing(self) -> FloatArray:
        """(n,) rad around the nest."""
        x, y, _ = self._model.nest
        place = (self._ends[0] + self._ends[1]) / 2.0
        return np.asarray(np.arctan2(place[:, 1] - y, place[:, 0] - x))

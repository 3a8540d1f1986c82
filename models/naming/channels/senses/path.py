"""Where robots were at every row of a log: what memory needs of rows that nobody judges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.sensing import averaged_poses, scenarios
from realitygap.models.gap.stood import poses_as_stood
from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog


@dataclass(frozen=True, eq=False, kw_only=True)
class Path:
    """Every row that the tracker saw, as in a `Sight`; made only when it is asked for."""

    log: MeasuredLog
    model: PointModel
    replayed: FloatArray
    """(rows of the log, 3), along which poses are averaged,"""
    half: int
    """rows on each side."""
    seen: Mapping[int, tuple[Motion, Motion]]
    """As of `look`."""

    @cached_property
    def rows(self) -> Rows:
        """(rows,) of the log, sorted by run and time."""
        tracked = np.flatnonzero(self.log.tracked)
        return np.asarray(tracked[np.lexsort((self.log.t[tracked], self.log.segment[tracked]))])

    @cached_property
    def run(self) -> Rows:
        """(rows,) the stretch of one robot's rows in one run."""
        return np.asarray(self.log.segment[self.rows])

    @cached_property
    def time(self) -> FloatArray:
        """(rows,) s since the run began."""
        start = self.log.t[self.log.start[:-1]][self.log.segment][self.rows]
        return np.asarray(self.log.t[self.rows] - start)

    @cached_property
    def scenario(self) -> npt.NDArray[np.int32]:
        """(rows,) lamp scenario, -1 where the log does not say."""
        return np.ascontiguousarray(scenarios(self.log)[self.rows])

    @cached_property
    def poses(self) -> FloatArray:
        """(rows, 3) m, m, rad."""
        poses, _ = averaged_poses(self.log, self.replayed, self.rows, self.half)
        stood = poses_as_stood(self.log, self.model, self.rows, poses, self.seen)
        return np.ascontiguousarray(stood)

"""A log cut for judging senses: where every robot stood, what it read, and what may be believed.

Rows are sorted by robot, run and time. A reading counts only where another robot's tracked body
cannot have anything to do with it: for infrared, none near the sensor's ray; for light, none near
the line of sight to the lamp below the height of a robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.believed import replay_believed
from realitygap.models.gap.sensing import averaged_poses, measured, rows_around, scenarios
from realitygap.models.gap.stood import commanded, poses_as_stood
from realitygap.models.log.blocks import BLOCK_SECONDS, nth
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise, pose_noise
from realitygap.models.naming.channels.senses.neighbours import Neighbours, around
from realitygap.models.naming.channels.senses.path import Path
from realitygap.models.naming.rules import Rules

Bools = npt.NDArray[np.bool_]
Rows = npt.NDArray[np.int64]

MOST_ROWS = 32_000
"""Rows used of a log, evenly in time: more sharpen nothing that differences between healthy robots
and errors of the captured tables leave visible. No rule: it bounds the work."""
BY_ROW = (
    "time",
    "run",
    "scenario",
    "poses",
    "spread",
    "read",
    "free",
    "block",
    "part",
    "commanded",
)
"""What a `Sight` has for every row."""
STATES = ("food", "nest")
"""Columns of the virtual sensor."""
NEAREST_LAMP = 0.12
"""m from the lamp below which the captured table is too coarse: its nodes lie 5 degrees apart.
No rule: of the tables."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Sight:
    """Rows of a log with what the senses told there."""

    robots: tuple[int, ...]
    begin: Rows
    """(robots + 1,) first row of each robot, and the row count."""
    time: FloatArray
    """(rows,) s since the run began."""
    run: Rows
    """(rows,) the stretch of one robot's rows in one run, counted through."""
    scenario: npt.NDArray[np.int32]
    """(rows,) lamp scenario, -1 where the log does not say."""
    poses: FloatArray
    """(rows, 3) m, m, rad: where the robot stood, its tracker's named faults taken off."""
    spread: FloatArray
    """(rows, 3) m, m, rad standard deviation of `poses`."""
    read: FloatArray
    """(rows, 16) counts, ps0..ps7 and ls0..ls7; NaN where not logged."""
    free: Bools
    """(rows, 16) nothing but wall and lamp can have caused the reading."""
    block: Rows
    """(rows,) counted through; a block is of one robot and run."""
    part: Rows
    """(rows,) part of the log (`log.held_out`)."""
    neighbours: Neighbours
    commanded: FloatArray
    """(rows, 2) m/s and rad/s of the wheels as commanded."""
    states: Mapping[str, FloatArray] = field(default_factory=dict)
    """(rows,) 1 where the virtual sensor says so, by column; what is not logged is absent."""
    path: Path | None = None
    """Of all rows of the log; None: these rows are all there are."""
    rules: Rules = field(default_factory=Rules)
    """By which windows are cut, and how far neighbours matter."""

    @property
    def robot(self) -> Rows:
        """(rows,) index into `robots`."""
        return np.repeat(np.arange(len(self.robots)), np.diff(self.begin))

    def rows_of(self, robot: int) -> slice:
        """Rows of a robot, given by index."""
        return slice(int(self.begin[robot]), int(self.begin[robot + 1]))

    def of(self, robot: int) -> Sight:
        """One robot's, given by index."""
        rows = np.arange(*self.begin[robot : robot + 2])
        some = self.only(rows)
        return replace(
            some, robots=(self.robots[robot],), begin=np.array([0, len(rows)], dtype=np.int64)
        )

    def only(self, rows: Rows) -> Sight:
        """Some rows, in order."""
        return replace(
            self,
            begin=np.searchsorted(rows, self.begin),
            neighbours=self.neighbours.only(rows),
            states={name: state[rows] for name, state in self.states.items()},
            **{name: getattr(self, name)[rows] for name in BY_ROW},
        )


def look(
    log: MeasuredLog,
    model: PointModel,
    seen: Mapping[int, tuple[Motion, Motion]] | None = None,
    *,
    moved: Mapping[int, Motion] | None = None,
    most: int = MOST_ROWS,
    rules: Rules = Rules(),
) -> Sight:
    """Cut a log.

    Args:
        log: Measured.
        model: What the simulator believes; with sensor tables.
        seen: By robot, its healthy motion and the one found: what the second has of marker offsets
            beyond the first is taken off the measured poses.
        moved: By robot, the motion found where it is not the model's: measured poses are averaged
            along it.
        most: Rows, evenly in time.
        rules: What naming is tuned to.
    """
    plain = Motion(drive=model.drive)
    robots = {int(robot) for robot in log.segments["robot"]}
    replayed = replay_believed(log, {r: (moved or {}).get(r, plain) for r in robots})
    noise = pose_noise(log, replayed)
    tracked = np.flatnonzero(log.tracked)
    robot_of = log.frame["robot"].to_numpy(dtype=np.int64)
    stride = max(1, -(-len(tracked) // most))
    tick = np.round((log.t - log.t.min()) / log.step).astype(np.int64)
    rows = tracked[tick[tracked] % stride == 0]
    rows = rows[np.argsort(robot_of[rows], kind="stable")]
    half = rows_around(log, replayed, noise)
    poses, count = averaged_poses(log, replayed, rows, half)
    ids, who = np.unique(robot_of[rows], return_inverse=True)
    poses = poses_as_stood(log, model, rows, poses, seen or {})
    scenario = np.ascontiguousarray(scenarios(log)[rows])
    neighbours = around(log, rows)
    free = np.hstack(
        [
            ~neighbours.in_ray(poses, model),
            lamp_in_sight(poses, scenario, neighbours, model),
        ]
    )
    start = log.t[log.start[:-1]][log.segment][rows]
    time = log.t[rows] - start
    key = log.segment[rows] * 10**6 + nth(time, BLOCK_SECONDS)
    return Sight(
        robots=tuple(int(r) for r in ids),
        begin=np.searchsorted(who, np.arange(len(ids) + 1)),
        time=time,
        run=log.segment[rows],
        scenario=scenario,
        poses=np.ascontiguousarray(poses),
        spread=_spread(noise, count),
        read=measured(log, rows),
        free=free & np.isfinite(measured(log, rows)),
        block=np.unique(key, return_inverse=True)[1],
        part=parts(log)[rows],
        neighbours=neighbours,
        commanded=commanded(log, model, rows),
        states=_states(log, rows),
        path=Path(log=log, model=model, replayed=replayed, half=half, seen=seen or {}),
    )


def _spread(noise: PoseNoise, count: Rows) -> FloatArray:
    """(rows, 3) standard deviation of averaged poses."""
    each = np.array([noise.position, noise.position, noise.heading])
    return np.asarray(each / np.sqrt(np.maximum(count, 1))[:, None])


def _states(log: MeasuredLog, rows: Rows) -> dict[str, FloatArray]:
    """What the virtual sensor said; unknown answers count as no."""
    return {
        name: np.asarray(log.frame[name].astype("Float64").fillna(0.0), dtype=np.float64)[rows]
        for name in STATES
        if name in log.frame
    }


def lamp_in_sight(
    poses: FloatArray,
    scenario: npt.NDArray[np.int32],
    neighbours: Neighbours,
    model: PointModel,
) -> Bools:
    """(rows, 8) nothing between a sensor and the lamp, and the lamp not too near."""
    free = np.repeat((scenario >= 0)[:, None], SENSORS, axis=1)
    for index, lamp in enumerate(model.lamps):
        mine = scenario == index
        if lamp is None or not mine.any():
            continue
        near = too_near(poses[mine], lamp)
        shaded = neighbours.only(mine).before_lamp(poses[mine], lamp, model)
        free[mine] &= ~(near[:, None] | shaded)
    return free


def too_near(poses: FloatArray, lamp: tuple[float, float]) -> Bools:
    """(rows,) too near a lamp for the captured table."""
    x, y = lamp
    return np.asarray(np.hypot(poses[:, 0] - x, poses[:, 1] - y) < NEAREST_LAMP)

"""A log cut for identification: robots one after the other, their tracks in short windows.

Within a window the predicted path may be shifted and turned as a whole, so that no error is carried
from one window to the next and no measured pose is trusted more than another. Rows at the wall, at
another robot or without a pose are in no window: contact is a cause of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.gap.conditions import carried_on, clear, conditions
from realitygap.models.gap.driven import AROUND
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.blocks import nth
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise, pose_noise
from realitygap.models.log.schema import ENCODERS
from realitygap.models.log.used import Used, used
from realitygap.models.naming.rules import Rules

LEAST_ROWS = 3
"""Rows a window needs: two poses only fix its place. No rule: three is the least that tells."""
BLOCK_WINDOWS = 5
"""Windows held out or resampled together, one after the other in time. No rule: blocks are of five
seconds everywhere."""

TURNED = ("left_turned", "right_turned")
"""Columns of `about` where there are encoders: rad each wheel has turned in its segment."""

Rows = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Tracks:
    """Commands and measured poses of some robots, sorted by robot, run and time."""

    robots: tuple[int, ...]
    """Who, in the order of `groups`."""
    t: FloatArray
    """(rows,) s; in a long log, rows that no window needs are left out."""
    commands: FloatArray
    """(rows, 2) rad/s."""
    start: Rows
    """(segments + 1,) first row of each segment (one robot in one run), and the row count."""
    segment_robot: Rows
    """(segments,) index into `robots`."""
    encoders: FloatArray | None
    """(rows, 2) rad/s measured at the wheels; None where not logged."""
    rolling: FloatArray | None = None
    """(segments, 2) rad/s of the wheels as segments begin (`MeasuredLog.rolling`)."""
    rows: Rows
    """(n,) rows that are in a window, in order."""
    first: Rows
    """(windows,) where each window begins in `rows`."""
    measured: FloatArray
    """(n, 3) measured poses of `rows`."""
    about: FloatArray
    """(rows, columns) conditions at every row, `columns` of them; for the search for structure."""
    columns: tuple[str, ...]
    noise: PoseNoise
    step: float
    """s, median time between rows of the log."""
    part: Rows
    """(rows,) part of the log (`log.held_out`)."""
    filtered: bool = False
    """Whether the tracker's noise hangs together as that of filtered poses does."""
    used: tuple[Used, ...] = ()
    """How much of each robot's time is in windows, and why not the rest."""
    body: float = 0.0
    """m, radius of a robot."""
    rules: Rules = field(default_factory=Rules)
    """By which they were cut, and by which all that is asked of them is judged."""

    @property
    def window(self) -> Rows:
        """(n,) window of each of `rows`."""
        return np.repeat(np.arange(len(self.first)), np.diff(np.append(self.first, len(self.rows))))

    @property
    def row_segment(self) -> Rows:
        """(rows,) segment of each row."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))

    @property
    def row_robot(self) -> Rows:
        """(rows,) index into `robots`."""
        return self.segment_robot[self.row_segment]

    @cached_property
    def seen(self) -> FloatArray:
        """(rows, 4) where laws find the robots (`gap.around`): x, y, yaw, distance to the next."""
        names = ("x", "y", "heading", "near_robot")
        seen = self.about[:, [self.columns.index(name) for name in names]]
        seen = seen + np.array([0.0, 0.0, 0.0, 2.0 * self.body])
        return carried_on(seen, np.isfinite(seen[:, :3]).all(axis=1), self.start)

    @property
    def since_start(self) -> FloatArray:
        """(rows,) s since the robot was last told to leave rest, or its run began."""
        moving = np.any(self.commands != 0.0, axis=1)
        started = moving & ~np.append(False, moving[:-1])
        started[self.start[:-1]] = True
        at = np.flatnonzero(started)
        return np.asarray(self.t - self.t[at[np.cumsum(started) - 1]])

    @property
    def robot(self) -> Rows:
        """(windows,) index into `robots`."""
        return self.row_robot[self.rows[self.first]]

    @property
    def block(self) -> Rows:
        """(windows,) block of each window, counted through; a block is of one robot."""
        robot = self.robot
        begin = np.searchsorted(robot, np.arange(len(self.robots)))
        within = (np.arange(len(robot)) - begin[robot]) // BLOCK_WINDOWS
        key = robot * (len(robot) + 1) + within
        return np.unique(key, return_inverse=True)[1]

    def only(self, chosen: npt.ArrayLike) -> Tracks:
        """The tracks of some robots, given by index into `robots`."""
        keep = np.zeros(len(self.robots), dtype=bool)
        keep[np.asarray(chosen, dtype=np.int64)] = True
        new_index = np.cumsum(keep) - 1
        rows_kept = keep[self.row_robot]
        in_rows = rows_kept[self.rows]
        length = np.diff(np.append(self.first, len(self.rows)))[keep[self.robot]]
        some = replace(
            self,
            rows=self.rows[in_rows],
            first=np.concatenate([[0], np.cumsum(length)[:-1]]).astype(np.int64),
            measured=self.measured[in_rows],
        )._of(rows_kept)
        return replace(
            some,
            robots=tuple(r for r, k in zip(self.robots, keep, strict=True) if k),
            segment_robot=new_index[some.segment_robot],
        )

    def needed(self) -> Tracks:
        """The tracks without rows that no window needs."""
        segment, t = self.row_segment, self.t
        far = 2.0 * (float(np.ptp(t)) + AROUND)  # keeps segments apart on one axis of time
        axis = t + far * segment
        used = axis[self.rows]
        after = np.searchsorted(used, axis)
        next_used = used[np.minimum(after, len(used) - 1)]
        last_used = used[np.maximum(after - 1, 0)]
        near = np.minimum(np.abs(next_used - axis), np.abs(axis - last_used)) <= AROUND
        near[self.start[:-1]] = True  # where its time begins
        return self._of(near)

    def _of(self, kept: npt.NDArray[np.bool_]) -> Tracks:
        """The tracks of some rows, all those of its windows among them."""
        number = np.add.reduceat(kept.astype(np.int64), self.start[:-1])
        return replace(
            self,
            t=self.t[kept],
            commands=np.ascontiguousarray(self.commands[kept]),
            start=np.concatenate([[0], np.cumsum(number[number > 0])]),
            segment_robot=self.segment_robot[number > 0],
            rolling=None if self.rolling is None else self.rolling[number > 0],
            encoders=None if self.encoders is None else self.encoders[kept],
            rows=(np.cumsum(kept) - 1)[self.rows],
            about=self.about[kept],
            part=self.part[kept],
        )

    def of_part(self, part: int) -> Tracks:
        """The tracks with the windows that lie in one part of the log; there may be none."""
        length = np.diff(np.append(self.first, len(self.rows)))
        inside = np.logical_and.reduceat(self.part[self.rows] == part, self.first)
        return replace(
            self,
            rows=self.rows[np.repeat(inside, length)],
            first=np.cumsum(np.append(0, length[inside]))[:-1].astype(np.int64),
            measured=self.measured[np.repeat(inside, length)],
        )


def cut_tracks(
    log: MeasuredLog,
    model: ModelFile,
    *,
    table: pd.DataFrame | None = None,
    rules: Rules = Rules(),
) -> Tracks:
    """The log's tracks in windows.

    Args:
        log: The measured log.
        model: Whose geometry says where contact is.
        table: The log's conditions; None: they are looked up.
        rules: Among them how long a window is; poses rarer than a third of it get windows of
            `LEAST_ROWS` of them.

    Raises:
        InputError: no robot has a single window of free motion; poses lie beyond the model's wall.
    """
    table = conditions(log, model) if table is None else table
    robots, who = np.unique(log.frame["robot"].to_numpy(dtype=np.int64), return_inverse=True)
    free = clear(table) & log.tracked
    order = np.argsort(who, kind="stable")  # robots first; runs and time stay in order
    t, stretch, segment = log.t[order], log.stretch[order], log.segment[order]
    step = _pose_step(t, free[order], who[order], log.step)
    seconds = max(rules.window, (LEAST_ROWS - 1) * step * 1.01)
    blocked = (log.tracked & ~free)[order]
    cut = _windows(t, free[order], blocked, stretch, who[order], seconds, step, rules)
    rows, first, thinned = cut.rows, cut.first, len(cut.unused) > 0
    if not len(first):
        raise _never_free(log, model)
    new = np.concatenate([[True], np.diff(segment) != 0])
    start = np.append(np.flatnonzero(new), len(t))
    noise = pose_noise(log, replay_log(log, model.point_model().drive))
    frame = log.frame
    encoders = None
    if set(ENCODERS) <= set(frame.columns) and frame[list(ENCODERS)].notna().any().all():
        encoders = frame[list(ENCODERS)].to_numpy(dtype=np.float64)[order]
    turned = [] if encoders is None else [_turned(t, encoders, start)]
    tracks = Tracks(
        robots=tuple(int(r) for r in robots),
        t=t,
        commands=np.ascontiguousarray(log.commands[order]),
        start=start,
        segment_robot=who[order][start[:-1]],
        encoders=encoders,
        rolling=None if log.rolling is None else log.rolling[segment[start[:-1]]],
        rows=rows,
        first=first,
        measured=log.poses[order][rows],
        about=np.hstack([table.to_numpy(dtype=np.float64)[order], *turned]),
        columns=(*table.columns, *(TURNED if turned else ())),
        noise=noise,
        step=log.step,
        part=parts(log)[order],
        body=model.robot.body_radius,
        used=used(log, clear(table), order[rows], order[cut.unused]),
        rules=rules,
    )
    return tracks.needed() if thinned else tracks


class _Cut(NamedTuple):
    """Windows of a log."""

    rows: Rows
    """In windows, in order."""
    first: Rows
    """(windows,) where in them each window begins."""
    unused: Rows
    """In windows that more than were wanted of a long log."""


def _turned(t: FloatArray, encoders: FloatArray, start: Rows) -> FloatArray:
    """(rows, 2) rad by the encoders, which give the mean speed since the row before."""
    took = np.diff(t, prepend=t[:1])
    took[start[:-1]] = 0.0
    total = np.cumsum(np.nan_to_num(encoders) * took[:, None], axis=0)
    return np.asarray(total - np.repeat(total[start[:-1]], np.diff(start), axis=0))


def _pose_step(t: FloatArray, free: npt.NDArray[np.bool_], who: Rows, step: float) -> float:
    """s, median time between free poses, at least that between rows: trackers may be slower."""
    rows = np.flatnonzero(free)
    took = np.diff(t[rows])[np.diff(who[rows]) == 0]
    return max(step, float(np.median(took))) if len(took) else step


def _never_free(log: MeasuredLog, model: ModelFile) -> InputError:
    """Why no robot ever moves clear of contact."""
    if model.arena is not None and log.tracked.any():
        reach = model.arena.radius - model.robot.body_radius
        out = float(np.mean(np.hypot(*log.poses[log.tracked, :2].T) > reach))
        if out == 1.0:
            return InputError(
                "log",
                f"every pose beyond the wall of model {model.name!r}",
                f"poses within {reach:g} m of (0, 0), or a model of the place",
            )
    return InputError("log", "no stretch of free motion", "robots that move clear of contact")


def _windows(
    t: FloatArray,
    free: npt.NDArray[np.bool_],
    blocked: npt.NDArray[np.bool_],
    stretch: Rows,
    who: Rows,
    seconds: float,
    step: float,
    rules: Rules,
) -> _Cut:
    """Rows in windows of at most so many seconds."""
    rows = np.flatnonzero(free)
    if not len(rows):
        return _Cut(rows, rows, rows)
    away = np.diff(np.cumsum(blocked)[rows]) > 0  # a contact between two rows ends a run of rows
    lost = np.diff(t[rows]) > 3.5 * step
    apart = (np.diff(stretch[rows]) != 0) | (np.diff(who[rows]) != 0)
    begin = np.concatenate([[True], away | lost | apart])
    run = np.cumsum(begin) - 1
    since = t[rows] - t[rows][begin][run]
    lasted = np.zeros(run[-1] + 1)
    np.maximum.at(lasted, run, since)
    pieces = np.maximum(1, np.ceil((lasted + step) / seconds - 0.2))
    piece = nth(since, ((lasted + step) / pieces)[run])
    new = begin | np.concatenate([[True], np.diff(piece) != 0])
    window = np.cumsum(new) - 1
    count = np.bincount(window)
    keep = count >= LEAST_ROWS
    usable = keep
    keep = keep & _spread(who[rows][new], keep, rules)
    unused = rows[(usable & ~keep)[window]]
    rows, window = rows[keep[window]], window[keep[window]]
    first = np.flatnonzero(np.concatenate([[True], np.diff(window) != 0])[: len(rows)])
    return _Cut(rows, first, unused)


def _spread(who: Rows, usable: npt.NDArray[np.bool_], rules: Rules) -> npt.NDArray[np.bool_]:
    """(windows,) of each robot's usable windows at most its share, evenly over its log."""
    keep = np.zeros(len(who), dtype=bool)
    robots = np.unique(who)
    most = min(rules.most_windows, max(rules.few_windows, rules.all_windows // len(robots)))
    for robot in robots:
        mine = np.flatnonzero((who == robot) & usable)
        if len(mine) > most:
            blocks = np.arange(len(mine)) // BLOCK_WINDOWS
            wanted = np.linspace(0, blocks[-1], most // BLOCK_WINDOWS).astype(np.int64)
            mine = mine[np.isin(blocks, wanted)]
        keep[mine] = True
    return keep

"""When a log's rows were written, and how its commands lie on them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.even import RESOLVED
from realitygap.models.log.measured import MeasuredLog


class Stamps(NamedTuple):
    """When rows came."""

    row_rate: float
    """Hz."""
    pose_rate: float | None
    """Hz of new poses; None: no two follow one another."""
    jitter: float
    """s, standard deviation of a row's time about even times."""
    gaps: int
    """Places where rows are missing or the track jumps."""
    repeats: float
    """Share of the rows that tell a robot to move and repeat the pose of the row before."""
    without: float
    """Share of rows without a pose, those aside that repeat one."""


class Commands(NamedTuple):
    """How commands change."""

    rate: float
    """Hz, changes of a robot's command."""
    together: float | None
    """Share of the changes that another follows in the very next row; None: no change has a row
    behind it. Near 1 commands may change between rows, where no row shows it."""


def stamps(log: MeasuredLog) -> Stamps:
    """When a log's rows came."""
    whole = np.diff(log.stretch) == 0
    step = np.diff(log.t)
    took = step[whole]
    off = took - np.round(took / log.step) * log.step
    # each step holds the errors of two stamps
    jitter = float(np.std(off) / np.sqrt(2.0)) if len(off) else 0.0
    known = np.flatnonzero(log.tracked)
    inside = np.diff(log.stretch[known]) == 0
    between = np.diff(log.t[known])[inside]
    missing = np.isnan(log.poses).any(axis=1)
    inner = np.diff(log.segment) == 0
    told = np.any(log.commands != 0.0, axis=1)
    return Stamps(
        row_rate=1.0 / log.step,
        pose_rate=1.0 / float(np.median(between)) if len(between) else None,
        jitter=max(jitter if jitter > RESOLVED else 0.0, log.jitter),
        gaps=int((inner & ~whole).sum()),
        repeats=float((_repeats(log) & told).sum() / max(int(told.sum()), 1)),
        without=float((missing & ~log.held).mean()),
    )


def commands(log: MeasuredLog) -> Commands:
    """How a log's commands change."""
    whole = np.diff(log.stretch) == 0
    change = np.any(np.diff(log.commands, axis=0) != 0.0, axis=1) & whole
    seconds = float(np.diff(log.t)[whole].sum())
    followed = whole[1:] & change[:-1]
    again = change[1:][followed]
    return Commands(
        rate=float(change.sum()) / seconds if seconds > 0.0 else 0.0,
        together=float(again.mean()) if len(again) else None,
    )


def _repeats(log: MeasuredLog) -> npt.NDArray[np.bool_]:
    """(rows,) the pose is that of the row before, whether or not it was taken for a held one."""
    poses: FloatArray = log.poses
    again = np.zeros(len(poses), dtype=bool)
    again[1:] = (poses[1:] == poses[:-1]).all(axis=1) & (np.diff(log.segment) == 0)
    return np.asarray(again | log.held)

"""What a discrepancy may depend on: the conditions at each row of a log, and bins of them.

A condition is a number per row: commanded speed and turn, how much the command just changed, time
since the log began, heading, place, nearness to the wall or another robot, what the virtual sensors
say, which robot and run. `bins` turns one into a few groups, so that a residual map is a table of
group means.

Laws find a robot at its measured pose, beside the next robot measured there, not where a replay has
carried it: the motion over a window stays the difference of two poses of one replay.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.frames import Rows
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.others import others

QUANTILE_BINS = 5
TIME_BINS = 6
SECTORS = 8
NEAR_WALL = 0.02
"""m between body and wall. Our choice: contact with margin for the tracker's lever arm."""
NEAR_ROBOT = 0.026
"""m between bodies: centres of two e-pucks within 96 mm, where contact disturbs motion."""
FAR = 1.0
"""m: other robots beyond this do not count."""

Groups = npt.NDArray[np.int64]


class Bins(NamedTuple):
    """A condition cut into groups."""

    group: Groups
    """(rows,) which group a row is in; -1: none."""
    labels: tuple[str, ...]
    """What each group is, for reading."""
    centres: tuple[float, ...]
    """Where each group lies on the condition's axis, for plotting."""


def conditions(log: MeasuredLog, model: ModelFile) -> pd.DataFrame:
    """One column per condition, one row per row of the log. SI units; NaN where unknown.

    Columns: speed (m/s), turn (rad/s), change (rad/s, of the faster changing wheel's command since
    the row before), time (s), heading (rad), x, y, radius (m), sector (rad), robot (index in
    `robots`), run (index); near_robot (m between bodies), and, with an arena, near_wall (m); food,
    nest (0, 1).
    """
    frame, robot = log.frame, model.robot
    left, right = log.commands.T * robot.wheel_radius
    change = np.zeros(len(frame))
    change[1:] = np.abs(np.diff(log.commands, axis=0)).max(axis=1)
    change[log.start[:-1]] = 0.0
    x, y, yaw = log.poses.T
    table = pd.DataFrame(
        {
            "speed": 0.5 * (left + right),
            "turn": (right - left) / robot.axle,
            "change": change,
            "time": log.t - log.t[log.start[:-1]][log.segment],
            "heading": np.mod(yaw, 2 * np.pi),
            "x": x,
            "y": y,
            "radius": np.hypot(x, y),
            "sector": np.mod(np.arctan2(y, x), 2 * np.pi),
            "robot": np.unique(frame["robot"], return_inverse=True)[1],
            "run": np.unique(frame["run"].astype(str), return_inverse=True)[1],
            "near_robot": nearest_robot(log) - 2 * robot.body_radius,
        }
    )
    if model.arena is not None:
        table["near_wall"] = model.arena.radius - robot.body_radius - table["radius"]
    for name in ("food", "nest"):
        if name in frame:
            table[name] = frame[name].astype("Float64").to_numpy(dtype=float, na_value=np.nan)
    return table


def nearest_robot(log: MeasuredLog) -> FloatArray:
    """(rows,) m to the nearest other robot's centre at that moment; inf beyond `FAR`."""
    distance = np.full(len(log.t), np.inf)
    rows = np.flatnonzero(log.tracked)
    place = log.poses[rows, :2]
    for _, at, there in others(log, rows):
        away = np.hypot(*(there - place[at]).T)
        distance[rows[at]] = np.fmin(distance[rows[at]], np.where(away < FAR, away, np.inf))
    return distance


def clear(table: pd.DataFrame) -> npt.NDArray[np.bool_]:
    """(rows,) neither at the wall nor at another robot: contact is a cause of its own."""
    ok = table["near_robot"].to_numpy() > NEAR_ROBOT
    if "near_wall" in table:
        ok &= table["near_wall"].to_numpy() > NEAR_WALL
    return np.asarray(ok)


def never_touching(table: pd.DataFrame, tracked: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """(rows,) clear as far as is known: of a row without a pose nothing is."""
    return clear(table) | ~tracked


def bins(name: str, values: FloatArray, *, names: tuple[str, ...] = ()) -> Bins:
    """Cut a condition into groups, by kind: angles into sectors, time evenly, the rest by quantile.

    Args:
        name: The condition.
        values: (n,) its values; NaN is in no group.
        names: For `robot` and `run`, what each index is called.
    """
    if name in ("heading", "sector"):
        edges = np.linspace(0, 2 * np.pi, SECTORS + 1)
        degrees = np.degrees(edges)
        labels = tuple(f"{a:.0f}-{b:.0f} deg" for a, b in pairwise(degrees))
        return _cut(values, edges, labels)
    if name in ("robot", "run"):
        present = np.arange(len(names))
        return Bins(values.astype(np.int64), names, tuple(map(float, present)))
    if name in ("food", "nest"):
        group = np.where(np.isnan(values), -1, np.nan_to_num(values)).astype(np.int64)
        return Bins(group, (f"not {name}", name), (0.0, 1.0))
    if name in ("near_wall", "near_robot"):
        limit = NEAR_WALL if name == "near_wall" else NEAR_ROBOT
        edges = np.array([-np.inf, limit, np.inf])
        return _cut(values, edges, (name.replace("_", " "), f"not {name.replace('_', ' ')}"))
    known = values[np.isfinite(values)]
    if not len(known):
        return Bins(np.full(len(values), -1), (), ())
    if name == "time":
        edges = np.linspace(known.min(), known.max(), TIME_BINS + 1)
    else:
        edges = np.quantile(known, np.linspace(0, 1, QUANTILE_BINS + 1))
    edges = np.unique(edges)
    if len(edges) < 2:
        edges = np.array([edges[0] - 0.5, edges[0] + 0.5])
    labels = tuple(f"{a:.3g} to {b:.3g}" for a, b in pairwise(edges))
    return _cut(values, edges, labels)


def _cut(values: FloatArray, edges: FloatArray, labels: tuple[str, ...]) -> Bins:
    """Groups between edges, the last edge included."""
    group = np.searchsorted(edges, values, side="right") - 1
    group = np.where(values == edges[-1], len(edges) - 2, group)
    outside = ~np.isfinite(values) & ~np.isinf(edges[-1]) | np.isnan(values)
    group = np.where(outside | (group < 0) | (group >= len(labels)), -1, group)
    finite = np.where(np.isfinite(edges), edges, np.nan)
    centres = 0.5 * (finite[:-1] + finite[1:])
    centres = np.where(np.isnan(centres), np.arange(len(centres)), centres)
    return Bins(group.astype(np.int64), labels, tuple(centres))


def edges_bins(values: FloatArray, edges: tuple[float, ...], unit: str) -> Bins:
    """Groups between given edges, the first and last of which may be infinite."""
    labels = tuple(f"{a:g} to {b:g} {unit}" for a, b in pairwise(edges))
    labels = tuple(
        text.replace("-inf to ", "below ").replace(" to inf", " and more") for text in labels
    )
    return _cut(values, np.array(edges), labels)


WHERE = {"heading", "radius", "place", "wall", "gap"}


def around(log: MeasuredLog, drive: Drive) -> FloatArray | None:
    """(rows, 4) x, y (m), yaw (rad), distance to the next robot's middle (m; inf: none).

    None where no law of the drive asks for it. Rows without a pose have the one before them.
    """
    if not asked(drive):
        return None
    gap = nearest_robot(log) if "gap" in asked(drive) else np.full(len(log.t), np.inf)
    return carried_on(np.column_stack([log.poses, gap]), log.tracked, log.start)


def asked(drive: Drive) -> set[str]:
    """Quantities of a drive's laws that tell where a robot is."""
    return WHERE.intersection(atom.of for law in drive.laws for atom in law.atoms)


def carried_on(seen: FloatArray, known: npt.NDArray[np.bool_], start: Rows) -> FloatArray:
    """(rows, ...) numbers, unknown rows as the last known one of their segment.

    Args:
        seen: (rows, ...).
        known: (rows,).
        start: (segments + 1,) first row of each segment, and the row count; those before a
            segment's first known row have that one, or zeros where there is none.
    """
    row = np.arange(len(seen))
    last = np.maximum.accumulate(np.where(known, row, -1))
    begin = np.repeat(start[:-1], np.diff(start))
    after = np.minimum.accumulate(np.where(known, row, len(seen))[::-1])[::-1]
    end = np.repeat(start[1:], np.diff(start))
    at = np.where(last >= begin, last, np.where(after < end, after, -1))
    return np.asarray(np.where((at >= 0)[:, None], seen[at], 0.0))

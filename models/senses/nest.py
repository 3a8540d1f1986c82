"""Where the virtual sensor says nest: a circle fitted to its answers at the measured places."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log import MeasuredLog

WIDTHS = (0.03, 0.008, 0.002, 0.0007)
"""m over which an answer changes from no to yes, from a first wide look to the last: at most what
a tracker's noise leaves open."""
WRONG = 2e-3
"""Share of answers that may be wrong for no reason."""
FOLDS = 4
BLOCK_SECONDS = 5.0
GAIN = 15.0
"""Held-out deviance that a change of the nest must take off."""
CLEARLY = 8.0
"""Deviance by which one explanation must be better than another."""
SHIFT, SCALE = 0.0003, 0.002
"""m and share by which the nest of a healthy swarm may seem changed. Our choice: the virtual sensor
is computed from the very poses that are logged."""
DISTANCE = 5.0
"""Of these, and of the fit's uncertainty, that a change must be."""
LEAST_CROSSINGS = 3
"""Changes of the answer that say anything."""
LEAST_SWARM = 3
ALIKE = 0.8
"""Of the robots that must do better with what the swarm is said to share."""

CAUSES = {"nest_moved": (0, 1), "nest_radius": (2,)}
"""Coordinates of each: m, m, logarithm of the radius' scale."""


class Answers(NamedTuple):
    """The virtual sensor's answers."""

    place: FloatArray
    """(rows, 2) m as measured."""
    inside: npt.NDArray[np.bool_]
    block: npt.NDArray[np.int64]
    """(rows,) counted through."""
    robot: npt.NDArray[np.int64]
    rows: npt.NDArray[np.int64]
    """(rows,) of the log."""


class NestFound(NamedTuple):
    """A change of the nest."""

    name: str
    robots: tuple[int, ...]
    """Ids."""
    whole_swarm: bool
    coordinates: FloatArray
    error: FloatArray
    gain: float
    share: float
    distance: float
    rivals: tuple[str, ...]


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
    )


def find(seen: Answers, nest: tuple[float, float, float]) -> list[NestFound]:
    """Every change of the nest, first of the whole swarm, then of single robots."""
    robots = np.unique(seen.robot)
    believed = np.zeros(3)
    found: list[NestFound] = []
    if len(robots) >= LEAST_SWARM:
        shared = _changes(seen, nest, believed, swarm=True)
        if shared and _most_agree(seen, nest, shared):
            found += shared
            for one in shared:
                believed[list(CAUSES[one.name])] += one.coordinates
    for robot in robots.tolist():
        found += _changes(only(seen, seen.robot == robot), nest, believed)
    return found


def crossed(seen: Answers) -> list[int]:
    """Ids of the robots whose answer changed often enough to say where the nest ends."""
    return [
        int(robot)
        for robot in np.unique(seen.robot)
        if np.count_nonzero(np.diff(seen.inside[seen.robot == robot])) >= LEAST_CROSSINGS
    ]


def lost_by(seen: Answers, nest: tuple[float, float, float], truth: FloatArray, name: str) -> float:
    """Deviance that the best change of one kind loses against a true change (3,) of the nest."""
    near = near_edge(seen, nest)
    best = fitted(near, nest, np.zeros(3), CAUSES[name])
    return float((_loss(near, nest, best) - _loss(near, nest, truth)).sum())


def only(seen: Answers, rows: npt.NDArray[np.bool_]) -> Answers:
    """Some of the answers."""
    place, inside, block, robot, of_log = seen
    return Answers(place[rows], inside[rows], block[rows], robot[rows], of_log[rows])


def _loss(
    seen: Answers, nest: tuple[float, float, float], at: FloatArray, width: float = WIDTHS[-1]
) -> FloatArray:
    """(rows,) deviance of the answers with the nest changed by `at` (3,)."""
    x, y, radius = nest[0] + at[0], nest[1] + at[1], nest[2] * np.exp(at[2])
    depth = (radius - np.hypot(seen.place[:, 0] - x, seen.place[:, 1] - y)) / width
    yes = 1.0 / (1.0 + np.exp(-np.clip(np.where(seen.inside, depth, -depth), -60.0, 60.0)))
    return np.asarray(-2.0 * np.log(0.5 * WRONG + (1.0 - WRONG) * yes))


def fitted(
    seen: Answers, nest: tuple[float, float, float], believed: FloatArray, free: tuple[int, ...]
) -> FloatArray:
    """(3,) change with some coordinates free."""
    here = believed.copy()
    columns = list(free)

    def lost(values: FloatArray, width: float) -> float:
        there = here.copy()
        there[columns] = values
        return float(_loss(seen, nest, there, width).sum())

    values = here[columns]
    for width in WIDTHS:
        size = 0.5 * width / np.where(np.array(columns) == 2, nest[2], 1.0)
        simplex = np.vstack([values, values + np.diag(np.resize(size, len(columns)))])
        done = minimize(
            lost,
            values,
            args=(width,),
            method="Nelder-Mead",
            options={"initial_simplex": simplex, "xatol": 1e-5, "fatol": 1e-3, "maxiter": 300},
        )
        values = np.asarray(done.x)
    if lost(values, WIDTHS[-1]) >= lost(believed[columns], WIDTHS[-1]):
        values = believed[columns]
    here[columns] = values
    return here


def _changes(
    seen: Answers,
    nest: tuple[float, float, float],
    believed: FloatArray,
    *,
    swarm: bool = False,
) -> list[NestFound]:
    """What one robot's answers, or all of them, say of the nest."""
    if np.count_nonzero(np.diff(seen.inside)) < LEAST_CROSSINGS:
        return []
    before = float(_loss(seen, nest, believed).sum())
    if before < GAIN:
        return []
    robots = tuple(int(robot) for robot in np.unique(seen.robot))
    seen = near_edge(seen, nest)
    before = float(_loss(seen, nest, believed).sum())
    fits = {name: fitted(seen, nest, believed, free) for name, free in CAUSES.items()}
    after = {n: float(_loss(seen, nest, f).sum()) + 2.0 * len(CAUSES[n]) for n, f in fits.items()}
    best = min(after, key=lambda n: after[n])
    names: tuple[str, ...] = (best,)
    fit = fits[best]
    both = fitted(seen, nest, fit, (0, 1, 2))
    if after[best] - float(_loss(seen, nest, both).sum()) > GAIN:
        names, fit = tuple(CAUSES), both
    error = _error(seen, nest, fit)
    gain = _held_out(seen, nest, believed, tuple(k for n in names for k in CAUSES[n]))
    found = []
    for name in names:
        columns = list(CAUSES[name])
        change = (fit - believed)[columns]
        wide = np.hypot(error[columns], SCALE if name == "nest_radius" else SHIFT)
        distance = float(np.sqrt(((change / wide) ** 2).sum()))
        if gain < GAIN or distance < DISTANCE:
            continue
        close = [n for n in after if n not in names and after[n] - after[best] < CLEARLY]
        found.append(
            NestFound(
                name,
                robots,
                swarm,
                change,
                wide,
                gain,
                gain / max(before, 1e-9),
                distance,
                tuple(close),
            )
        )
    return found


def near_edge(seen: Answers, nest: tuple[float, float, float]) -> Answers:
    """Without answers so far inside or outside that no believable nest would change them."""
    away = np.abs(np.hypot(seen.place[:, 0] - nest[0], seen.place[:, 1] - nest[1]) - nest[2])
    expected = np.hypot(seen.place[:, 0] - nest[0], seen.place[:, 1] - nest[1]) < nest[2]
    wrong = expected != seen.inside
    reach = 0.05 + (float(away[wrong].max()) if wrong.any() else 0.0)
    return only(seen, away < reach)


def _error(seen: Answers, nest: tuple[float, float, float], fit: FloatArray) -> FloatArray:
    """(3,) standard errors of each coordinate alone, by the curvature over a width."""
    steps = np.array([0.0007, 0.0007, 0.0007 / nest[2]])
    here = float(_loss(seen, nest, fit).sum())
    error = np.zeros(3)
    for k, step in enumerate(steps):
        moved = np.zeros(3)
        moved[k] = step
        up, down = (float(_loss(seen, nest, fit + sign * moved).sum()) for sign in (1, -1))
        bend = max((up + down - 2.0 * here) / step**2 / 2.0, 1e-6)
        error[k] = bend**-0.5
    return error


def _held_out(
    seen: Answers, nest: tuple[float, float, float], believed: FloatArray, free: tuple[int, ...]
) -> float:
    """Deviance taken off blocks that were not fitted."""
    gain = 0.0
    fold = (seen.block * 7919 % 104729) % FOLDS
    for k in range(FOLDS):
        out = fold == k
        if not out.any() or out.all():
            continue
        fit = fitted(only(seen, ~out), nest, believed, free)
        rest = only(seen, out)
        gain += float((_loss(rest, nest, believed) - _loss(rest, nest, fit)).sum())
    return gain


def _most_agree(seen: Answers, nest: tuple[float, float, float], shared: list[NestFound]) -> bool:
    """Whether most robots that crossed the edge do better with what is said to be shared."""
    change = np.zeros(3)
    for one in shared:
        change[list(CAUSES[one.name])] += one.coordinates
    better = []
    for robot in crossed(seen):
        mine = only(seen, seen.robot == robot)
        gain = _loss(mine, nest, np.zeros(3)).sum() - _loss(mine, nest, change).sum()
        better.append(gain > 0.0)
    return bool(better) and float(np.mean(better)) >= ALIKE

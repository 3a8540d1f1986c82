"""The motion the point model gets wrong: windows of a log, their errors, what they depend on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.conditions import Bins, bins, never_touching
from realitygap.models.gap.flips import Means, residual_maps, scores
from realitygap.models.gap.replay import CHANNELS, HORIZONS, errors, windows
from realitygap.models.gap.shares import Share, split
from realitygap.models.gap.spread import Excess, excess
from realitygap.models.log.blocks import BLOCK_SECONDS
from realitygap.models.log.frames import Windows, motion
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import PoseNoise, window_noise

UNITS = {"along": "m", "across": "m", "heading": "rad"}
MOST_BLOCKS = 2000
"""More blocks sharpen nothing; longer blocks keep the cost of a long log down."""
CLEAR_TO = 1.0
"""s; windows longer than this nearly always meet a wall or a robot, so none are set apart."""
CONTACT = ("near_wall", "near_robot")
MOTION_CONDITIONS = (
    "all",
    "speed",
    "turn",
    "change",
    "speed_change",
    "turn_change",
    "heading",
    "radius",
    "sector",
    "time",
    "robot",
    "run",
    *CONTACT,
    "food",
    "nest",
)


class MotionGap(NamedTuple):
    """One horizon of a log."""

    horizon: str
    seconds: float
    pairs: Windows
    error: FloatArray
    """(windows, 3) measured minus predicted, `CHANNELS`."""
    noise: FloatArray
    """(windows, 3) standard deviation of noise alone."""
    table: pd.DataFrame
    """(windows,) conditions of each window."""
    clear: npt.NDArray[np.bool_]
    """(windows,) free of contact, or all of them where nothing is set apart."""
    shares: dict[str, Share]
    maps: list[Means]
    excess: dict[str, Excess]
    """By channel: whether clear windows' errors spread more than noise."""


def motion_gap(
    log: MeasuredLog,
    replayed: FloatArray,
    noise: PoseNoise,
    table: pd.DataFrame,
    seed: np.random.SeedSequence,
    *,
    family: int = len(HORIZONS),
) -> list[MotionGap]:
    """Every horizon the log is long enough for.

    Args:
        log: The measured log.
        replayed: (rows, 3) its commands through the model.
        noise: The tracker's.
        table: Conditions of the log's rows.
        seed: Of the random turns of the sign-flip test.
        family: How many families of maps are judged together.
    """
    generators = [np.random.default_rng(child) for child in seed.spawn(len(HORIZONS))]
    found = [
        _horizon(log, replayed, noise, table, name, rng, family)
        for name, rng in zip(HORIZONS, generators, strict=True)
    ]
    return [gap for gap in found if gap is not None]


def _horizon(
    log: MeasuredLog,
    replayed: FloatArray,
    noise: PoseNoise,
    table: pd.DataFrame,
    name: str,
    rng: np.random.Generator,
    family: int,
) -> MotionGap | None:
    """One horizon, or None where no window fits."""
    pairs, between = _judged(log, HORIZONS[name])
    if not len(pairs.first):
        return None
    seconds = float(np.median(log.t[pairs.last] - log.t[pairs.first]))
    error = _unshrunk(errors(log.poses, replayed, pairs), replayed, pairs, noise)
    floor = window_noise(log.poses, pairs, noise)
    conditions = window_conditions(log, table, pairs, between)
    free = np.ones(len(pairs.first), dtype=bool)
    if seconds <= CLEAR_TO:
        free = throughout(never_touching(table, log.tracked), pairs)
    if not free.any():
        free[:] = True
    maps = _maps(log, error, floor, conditions, free, pairs, rng, family)
    shares = {c: split(error[free, k], floor[free, k]) for k, c in enumerate(CHANNELS)}
    block = blocks(log, pairs.first, seconds)[free]
    larger = {
        c: excess(error[free, k], floor[free, k], block, family=family * len(CHANNELS))
        for k, c in enumerate(CHANNELS)
    }
    return MotionGap(name, seconds, pairs, error, floor, conditions, free, shares, maps, larger)


def _judged(log: MeasuredLog, length: float) -> tuple[Windows, npt.NDArray[np.int64]]:
    """Windows that share no measurement, and a row of each that says where it was.

    That row's noise must be in no window's error: the tracked row nearest to the middle of a
    window, or, for windows of one step, the row before. Where no such row is tracked, the place of
    the window is unknown.
    """
    pairs = windows(log, length, apart=True)
    middle = _tracked_inside(log, pairs, (pairs.first + pairs.last) // 2)
    middle = np.where(pairs.last - pairs.first > 1, middle, pairs.first - 1)
    ok = (middle >= 0) & (log.stretch[middle] == log.stretch[pairs.first])
    return Windows(pairs.first[ok], pairs.last[ok]), middle[ok]


def _tracked_inside(
    log: MeasuredLog, pairs: Windows, wanted: npt.NDArray[np.int64]
) -> npt.NDArray[np.int64]:
    """(windows,) the tracked row nearest to the wanted one, or that one where none lies inside."""
    tracked = np.flatnonzero(log.tracked)  # holds the windows' ends
    above = np.searchsorted(tracked, wanted).clip(1, len(tracked) - 1)
    both = np.stack([tracked[above - 1], tracked[above]])
    inside = (both > pairs.first) & (both < pairs.last)
    away = np.where(inside, np.abs(both - wanted), len(log.t))
    nearest = np.take_along_axis(both, away.argmin(axis=0)[None], axis=0)[0]
    return np.where(inside.any(axis=0), nearest, wanted)


def _unshrunk(
    error: FloatArray, replayed: FloatArray, pairs: Windows, noise: PoseNoise
) -> FloatArray:
    """Errors without the shortening that a noisy start heading gives every measured path on
    average.

    A vector seen from a heading that is off by a normal error keeps exp(-variance / 2) of its
    length.
    """
    lost = 1.0 - np.exp(-0.5 * noise.heading**2)
    error = error.copy()
    error[:, :2] += lost * motion(replayed, pairs)[:, :2]
    return error


def window_conditions(
    log: MeasuredLog, table: pd.DataFrame, pairs: Windows, middle: npt.NDArray[np.int64]
) -> pd.DataFrame:
    """(windows,) conditions: commands averaged over the window, the rest at its middle row.

    `speed_change` and `turn_change` are the last command before a window's end less the last one
    before its start: what latency and slow motors lose or gain over it.
    """
    result = table.iloc[middle].reset_index(drop=True)
    held = np.append(np.diff(log.t), 0.0)
    took = log.t[pairs.last] - log.t[pairs.first]
    for name in ("speed", "turn"):
        integral = np.concatenate([[0.0], np.cumsum(table[name].to_numpy() * held)])
        result[name] = (integral[pairs.last] - integral[pairs.first]) / took
        before = np.maximum(pairs.first - 1, log.start[:-1][log.segment[pairs.first]])
        last = table[name].to_numpy()
        result[f"{name}_change"] = last[pairs.last - 1] - last[before]
    changed = np.concatenate([[0.0], np.cumsum(table["change"].to_numpy())])
    result["change"] = changed[pairs.last] - changed[pairs.first]
    return result


def condition_bins(log: MeasuredLog, table: pd.DataFrame) -> dict[str, Bins]:
    """Groups of every condition that varies in these rows."""
    names = {
        "robot": tuple(f"robot {log.names[r]}" for r in np.unique(log.frame["robot"])),
        "run": tuple(f"run {r}" for r in np.unique(log.frame["run"].astype(str))),
    }
    cuts = {"all": Bins(np.zeros(len(table), dtype=np.int64), ("all",), (0.0,))}
    for name in MOTION_CONDITIONS[1:]:
        if name in table:
            cut = bins(name, table[name].to_numpy(dtype=float), names=names.get(name, ()))
            if len(cut.labels) > 1:
                cuts[name] = cut
    return cuts


def blocks(log: MeasuredLog, rows: npt.NDArray[np.int64], seconds: float) -> npt.NDArray[np.int64]:
    """(n,) block of each row: stretches of one robot's time that are turned together."""
    start = log.start
    total = float((log.t[start[1:] - 1] - log.t[start[:-1]]).sum())
    length = max(BLOCK_SECONDS, seconds + 2 * log.step, total / MOST_BLOCKS)
    since = log.t[rows] - log.t[start[:-1]][log.segment[rows]]
    most = int(total / length) + 2
    return log.segment[rows] * most + np.floor(since / length).astype(np.int64)


def _maps(
    log: MeasuredLog,
    error: FloatArray,
    floor: FloatArray,
    table: pd.DataFrame,
    free: npt.NDArray[np.bool_],
    pairs: Windows,
    rng: np.random.Generator,
    family: int,
) -> list[Means]:
    """All maps of one horizon: contact over all windows, everything else over the clear ones."""
    seconds = float(np.median(log.t[pairs.last] - log.t[pairs.first]))
    found = scores(error, floor, blocks(log, pairs.first, seconds))
    cuts = condition_bins(log, table)
    kept = {
        name: cut if name in CONTACT else cut._replace(group=np.where(free, cut.group, -1))
        for name, cut in cuts.items()
    }
    return residual_maps(found, kept, CHANNELS, rng, family=family)


def throughout(ok: npt.NDArray[np.bool_], pairs: Windows) -> npt.NDArray[np.bool_]:
    """(windows,) whether every row of a window is ok."""
    bad = np.concatenate([[0], np.cumsum(~ok)])
    return np.asarray(bad[pairs.last + 1] == bad[pairs.first])

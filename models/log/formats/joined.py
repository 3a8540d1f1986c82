"""Commands and poses logged by different clocks or at different rates, joined on time.

Of two series of like rates the slower keeps its own times: a row of the measured log stands at each
time a command was given or, where commands come faster than poses, at each pose and each change of
command. Commands more than `BRIDGE` times rarer than poses are no series but events: then, too, a
row stands at each pose and each change. Commands hold until the next one and are never
interpolated. Poses are interpolated linearly between the two around a row (yaw along the shorter
turn) unless these lie further apart than `BRIDGE` times their usual distance: there the pose is
missing.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import wrapped

BRIDGE = 2.5
"""Usual distances between poses that are bridged by interpolation: one lost pose. Our choice."""


def join(
    command_t: FloatArray, commands: FloatArray, pose_t: FloatArray, poses: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rows (t, commands, poses) of one robot on common times.

    Args:
        command_t: (commands,) s, increasing.
        commands: (commands, 2).
        pose_t: (poses,) s, increasing.
        poses: (poses, 3).

    Raises:
        InputError: one series has fewer than two rows, or they do not overlap in time.
    """
    for name, t in (("commands", command_t), ("poses", pose_t)):
        if len(t) < 2:
            raise InputError(name, f"{len(t)} rows with all their values", "at least two")
    low, high = max(command_t[0], pose_t[0]), min(command_t[-1], pose_t[-1])
    if not low < high:
        raise InputError(
            "time",
            f"commands from {command_t[0]:g} to {command_t[-1]:g} s, poses from {pose_t[0]:g} to "
            f"{pose_t[-1]:g} s",
            "two series of one clock that overlap",
        )
    slower = np.median(np.diff(command_t)) / np.median(np.diff(pose_t))
    series_of_its_own = 1.0 <= slower <= BRIDGE
    t = command_t if series_of_its_own else _changes(command_t, commands, pose_t)
    t = t[(t >= low) & (t <= high)]
    held = np.searchsorted(command_t, t, side="right") - 1
    return t, commands[held], interpolated(pose_t, poses, t)


def latest(t: FloatArray, *columns: FloatArray) -> tuple[FloatArray, ...]:
    """A series with increasing time: of rows with one time the last is kept."""
    keep = np.ones(len(t), dtype=bool)
    keep[:-1] = np.diff(t) > 0
    return (t[keep], *(column[keep] for column in columns))


def _changes(command_t: FloatArray, commands: FloatArray, pose_t: FloatArray) -> FloatArray:
    """Times of poses, and of the commands that change something: a held command needs no row."""
    changed = np.ones(len(command_t), dtype=bool)
    changed[1:] = (np.diff(commands, axis=0) != 0).any(axis=1)
    times: FloatArray = np.union1d(pose_t, command_t[changed])
    return times


def interpolated(pose_t: FloatArray, poses: FloatArray, t: FloatArray) -> FloatArray:
    """(rows, columns) poses at other times, NaN where the poses around are too far apart.

    Args:
        pose_t: (poses,) s, increasing.
        poses: (poses, columns); a third column is an angle (rad), which takes the shorter turn.
        t: (rows,) s.
    """
    after = np.clip(np.searchsorted(pose_t, t), 1, len(pose_t) - 1)
    before = after - 1
    apart = pose_t[after] - pose_t[before]
    weight = np.clip((t - pose_t[before]) / apart, 0.0, 1.0)[:, None]
    change = poses[after] - poses[before]
    change[:, 2:3] = wrapped(change[:, 2:3])
    result = poses[before] + weight * change
    exact = (t == pose_t[before]) | (t == pose_t[after])
    far = (apart > BRIDGE * np.median(np.diff(pose_t))) & ~exact
    result[far] = np.nan
    return result


def series(
    table: pd.DataFrame, time: str, names: list[str]
) -> tuple[FloatArray, npt.NDArray[np.float64]]:
    """A table's time and columns as arrays, in order of time, rows with holes left out.

    Raises:
        InputError: a value is infinite.
    """
    usable = table[[time, *names]].dropna().sort_values(time, kind="stable")
    t, values = usable[time].to_numpy(dtype=float), usable[names].to_numpy(dtype=float)
    if not (np.isfinite(t).all() and np.isfinite(values).all()):
        raise InputError(" or ".join([time, *names]), "infinite values", "numbers")
    return t, values

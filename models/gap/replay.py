"""Replay: where the point model says a robot should be, from where it was measured to be.

The commands of a whole log are integrated once; the motion over any window is the difference of two
poses of that one replay, so all robots, windows and horizons cost one call into C.
"""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim import Drive, replay
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.conditions import around
from realitygap.models.log.frames import Rows, Windows, motion, wrapped
from realitygap.models.log.measured import GAP_STEPS, MeasuredLog

HORIZONS = {"step": 0.0, "0.4 s": 0.4, "1 s": 1.0, "5 s": 5.0, "20 s": 20.0}
"""Window lengths (s) by name; `step` is from one row to the next."""
TOLERANCE = 0.3
"""Most share by which a window may differ from its length; slower logs have no such window."""
CHANNELS = ("along", "across", "heading")
"""Error at a window's end in the frame of its start pose: m ahead, m to the left, rad."""


def windows(log: MeasuredLog, length: float, *, apart: bool = False) -> Windows:
    """All windows of a length (s; 0: one row), from every tracked row at which one starts.

    Args:
        log: The measured log.
        length: s, or 0 for one row.
        apart: Only windows with at least one whole row between them, as statistics of independent
            samples need: no measurement is shared, and the row between is free to say where it was.
    """
    rows = len(log.t)
    first = np.arange(rows)
    last = first + 1 if length == 0 else _row_after(log, length)
    ok = last < rows
    first, last = first[ok], last[ok]
    ok = (log.stretch[first] == log.stretch[last]) & log.tracked[first] & log.tracked[last]
    first, last = first[ok], last[ok]
    took = log.t[last] - log.t[first]
    if length:
        ok = np.abs(took - length) <= min(TOLERANCE * length, 0.5 * GAP_STEPS * log.step)
        first, last = first[ok], last[ok]
    found = Windows(first, last)
    return _apart(found, log) if apart else found


def _row_after(log: MeasuredLog, length: float) -> Rows:
    """(rows,) for each row the row of its segment nearest to `length` later, or the row count."""
    span = log.t - log.t[log.start[:-1]][log.segment]
    key = span + log.segment * (span.max() + 2 * length + 1)
    wanted = key + length
    # a thousandth of a step: written times are rounded
    above = np.searchsorted(key, wanted - 1e-3 * log.step)
    end = log.start[1:][log.segment]
    beyond = above >= end
    above = above.clip(1, len(key) - 1)
    below = above - 1
    nearest: Rows = np.where(wanted - key[below] <= key[above] - wanted, below, above)
    nearest[beyond | (nearest <= np.arange(len(key)))] = len(key)
    return nearest


def _apart(found: Windows, log: MeasuredLog) -> Windows:
    """Windows one after the other: the first in each cell of a grid of length plus two steps."""
    if not len(found.first):
        return found
    took = float(np.median(log.t[found.last] - log.t[found.first]))
    since = log.t[found.first] - log.t[log.start[:-1]][log.segment[found.first]]
    cell = np.floor((since + 0.25 * log.step) / (took + 2 * log.step)).astype(np.int64)
    stretch = log.stretch[found.first]
    new = np.ones(len(cell), dtype=bool)
    new[1:] = (cell[1:] != cell[:-1]) | (stretch[1:] != stretch[:-1])
    first, last = found.first[new], found.last[new]
    ok = np.ones(len(first), dtype=bool)
    ok[1:] = (first[1:] >= last[:-1] + 2) | (log.segment[first[1:]] != log.segment[first[:-1]])
    return Windows(first[ok], last[ok])


def replay_log(log: MeasuredLog, drive: Drive) -> FloatArray:
    """(rows, 3) poses of the log's commands through a motion model, each segment from the origin.

    Raises:
        embedded_sim.Diverged: a pose left the finite numbers.
    """
    origin = np.zeros((len(log.segments), 3))
    seen = around(log, drive)
    return replay(
        log.t, log.commands, log.start, origin, drive=drive, rolling=log.rolling, seen=seen
    ).poses


def errors(measured: FloatArray, replayed: FloatArray, pairs: Windows) -> FloatArray:
    """(windows, 3) measured minus predicted at each window's end; columns `CHANNELS`.

    The prediction starts at the measured pose: it is that pose moved by the replayed motion.
    """
    error = motion(measured, pairs) - motion(replayed, pairs)
    error[:, 2] = wrapped(error[:, 2])
    return error

"""Is a residual structured? A sign-flip test, exact for errors that are symmetric noise.

If the model is right, what is left of a window's error is the tracker's noise: as likely positive
as negative, and independent from one window to the next as long as they share no measurement. Then
turning the sign of whole blocks of windows changes nothing, and the largest group mean over all
channels, conditions and groups can be compared with its distribution under random turns. Blocks
(several windows in a row) keep the test honest when noise lasts longer than a window. The test
needs no noise level, no normality and no threshold set by hand, and holds the rate of false alarms
over a whole family of maps.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.conditions import Bins
from realitygap.models.log.tracker import NORMAL

FLIPS = 999
"""Random turns: the smallest p-value is 0.001."""
CLIP = 4.0
"""Robust standard deviations beyond which an error counts no more: gross failures of a tracker."""
LEAST_BLOCKS = 12
"""Fewer blocks cannot reach the 5 % level after turning: 2^-11 over the maps of one horizon."""
NEGLIGIBLE = 1e-9
"""m or rad; smaller errors are rounding and count as none."""


class Means(NamedTuple):
    """Group means of one channel over one condition."""

    condition: str
    channel: str
    labels: tuple[str, ...]
    centres: tuple[float, ...]
    number: npt.NDArray[np.int64]
    """(groups,) windows."""
    mean: FloatArray
    """(groups,) of the clipped error; in the channel's unit."""
    error: FloatArray
    """(groups,) standard error of the mean, by blocks."""
    rms: FloatArray
    """(groups,) robust root mean square: 1.48 times the median size of the errors; NaN if empty."""
    z: FloatArray
    """(groups,) mean over its standard error; 0 where a group has too few blocks."""
    p: float
    """Share of random turns with a larger |z| anywhere in the family: family-wise."""


class Scores(NamedTuple):
    """Errors with gross failures clipped, and what they are counted by."""

    value: FloatArray
    """(windows, channels)."""
    block: npt.NDArray[np.int64]
    """(windows,) 0..blocks-1."""


def scores(error: FloatArray, noise: FloatArray, block: npt.NDArray[np.int64]) -> Scores:
    """Errors clipped at `CLIP` robust standard deviations of their channel, relative to their
    noise.

    Args:
        error: (windows, channels).
        noise: (windows, channels) standard deviation expected of noise alone, > 0.
        block: (windows,) any labels.
    """
    ratio = error / noise
    spread = np.maximum(NORMAL * np.nanmedian(np.abs(ratio), axis=0), 1.0)
    clipped = np.clip(ratio, -CLIP * spread, CLIP * spread) * noise
    clipped = np.where(np.abs(clipped) < NEGLIGIBLE, 0.0, clipped)
    return Scores(clipped, np.unique(block, return_inverse=True)[1])


def residual_maps(
    found: Scores,
    conditions: dict[str, Bins],
    channels: tuple[str, ...],
    rng: np.random.Generator,
    *,
    family: int = 1,
) -> list[Means]:
    """Every channel's group means over every condition, with family-wise p-values.

    Args:
        found: Scores of windows that share no measurement.
        conditions: Groups of the same windows, by condition.
        channels: Names of the scores' columns.
        rng: Draws the turns.
        family: How many such families are judged together (Bonferroni).
    """
    blocks = int(found.block.max()) + 1 if len(found.block) else 0
    value = np.nan_to_num(found.value)
    known = np.isfinite(found.value)
    parts, largest = [], np.zeros(FLIPS)
    turns = rng.integers(0, 2, (FLIPS, blocks)).astype(np.float32) * 2 - 1
    for name, cut in conditions.items():
        groups = len(cut.labels)
        if not groups or not blocks:
            continue
        total, count, present = _sums(value, known, cut, found.block, blocks, groups)
        scale = np.sqrt((total**2).sum(axis=0))
        usable = (present >= LEAST_BLOCKS) & (scale > 0)
        safe = np.where(usable, scale, 1.0)
        z = np.where(usable, total.sum(axis=0) / safe, 0.0)
        flat = (total / safe * usable).reshape(blocks, -1)
        flat = flat[:, usable.ravel()].astype(np.float32)
        if flat.size:
            largest = np.maximum(largest, np.abs(turns @ flat).max(axis=1))
        parts.append((name, cut, total, count, scale, z))
    maps = []
    for name, cut, total, count, scale, z in parts:
        for k, channel in enumerate(channels):
            top = np.abs(z[:, k]).max(initial=0.0)
            beaten = 1 + int((largest >= top * (1 - 1e-6)).sum())
            p = min(1.0, family * beaten / (FLIPS + 1)) if top > 0 else 1.0
            n = np.maximum(count[:, k], 1)
            mean, error = total[:, :, k].sum(axis=0) / n, scale[:, k] / n
            rms = _sizes(found.value[:, k], cut)
            maps.append(
                Means(
                    name,
                    channel,
                    cut.labels,
                    cut.centres,
                    count[:, k],
                    mean,
                    error,
                    rms,
                    z[:, k],
                    p,
                )
            )
    return maps


def _sizes(value: FloatArray, cut: Bins) -> FloatArray:
    """(groups,) robust root mean square of a channel's errors."""
    inside = (cut.group >= 0) & np.isfinite(value)
    order = np.argsort(cut.group[inside], kind="stable")
    size, group = np.abs(value[inside])[order], cut.group[inside][order]
    edges = np.searchsorted(group, np.arange(len(cut.labels) + 1))
    parts = [size[a:b] for a, b in pairwise(edges)]
    return NORMAL * np.array([np.median(part) if len(part) else np.nan for part in parts])


def _sums(
    value: FloatArray,
    known: npt.NDArray[np.bool_],
    cut: Bins,
    block: npt.NDArray[np.int64],
    blocks: int,
    groups: int,
) -> tuple[FloatArray, npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Sums (blocks, groups, channels), windows (groups, channels) and blocks present per group."""
    inside = cut.group >= 0
    cell = block[inside] * groups + cut.group[inside]
    channels, size = value.shape[1], blocks * groups
    total, number = np.empty((2, blocks, groups, channels))
    for k in range(channels):
        total[:, :, k] = np.bincount(cell, value[inside, k], size).reshape(blocks, groups)
        number[:, :, k] = np.bincount(cell, known[inside, k], size).reshape(blocks, groups)
    return total, number.sum(axis=0).astype(np.int64), (number > 0).sum(axis=0)

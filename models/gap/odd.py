"""Which robot is unlike the others? Its motion errors against the swarm's, under like commands.

What a simulator lacks for all robots alike (motors, friction) cancels; what is left is the robot's
own. The question is answered by exchanging: if robots are alike, any stretch of ten seconds could
have been any robot's, so the largest deviation of one robot from the swarm's median is compared
with its distribution when stretches are dealt to robots at random.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.conditions import Bins
from realitygap.models.log.frames import Rows
from realitygap.models.log.tracker import NORMAL

DEALS = 999
"""Random deals: the smallest p-value is 0.001."""
CLIP = 4.0
"""Robust standard deviations beyond which a stretch counts no more: contacts, tracker failures."""
LEAST = 3
"""Stretches a robot needs in a group to be judged there."""


class Odd(NamedTuple):
    """One robot against the swarm."""

    robot: str
    p: float
    """Share of random deals with a larger deviation of any robot, channel and group."""
    channel: str
    """Where it deviates most."""
    condition: str
    group: str
    deviation: float
    """Mean error less the swarm's median, in the channel's unit."""
    z: float


def odd_robots(
    error: FloatArray,
    robot: Bins,
    stretch: Rows,
    conditions: dict[str, Bins],
    channels: tuple[str, ...],
    rng: np.random.Generator,
) -> list[Odd]:
    """Every robot's largest deviation from the swarm; empty with fewer than three robots.

    Args:
        error: (windows, channels).
        robot: The windows' robots.
        stretch: (windows,) which stretch of time of one robot a window is in.
        conditions: Groups of like commands.
        channels: Names of the columns of `error`.
        rng: Deals the stretches.
    """
    robots = len(robot.labels)
    if robots < 3 or not len(error):
        return []
    _, first, index = np.unique(stretch, return_index=True, return_inverse=True)
    owner = robot.group[first]
    cells = [(name, k) for name, cut in conditions.items() for k in range(len(cut.labels))]
    values = np.stack(
        [_stretch_means(error, index, conditions[name].group == k) for name, k in cells], axis=1
    )
    flat = values.reshape(len(owner), -1)
    clipped, scale = _clip(flat)
    known = np.isfinite(clipped)
    filled = np.where(known, clipped, 0.0)
    z, deviation = _deviations(filled, known, owner, robots, scale)
    largest = np.empty(DEALS)
    for deal in range(DEALS):
        dealt = _deviations(filled, known, rng.permutation(owner), robots, scale)[0]
        largest[deal] = np.abs(dealt).max()
    result = []
    for r, name in enumerate(robot.labels):
        at = int(np.abs(z[r]).argmax())
        cell, channel = divmod(at, len(channels))
        condition, group = cells[cell]
        p = (1 + int((largest >= abs(z[r, at])).sum())) / (DEALS + 1)
        label = conditions[condition].labels[group]
        found = float(deviation[r, at]), float(z[r, at])
        result.append(Odd(name, p, channels[channel], condition, label, *found))
    return result


def _stretch_means(error: FloatArray, index: Rows, inside: npt.NDArray[np.bool_]) -> FloatArray:
    """(stretches, channels) mean error of a stretch's windows in a group; NaN where it has none."""
    stretches = int(index.max()) + 1
    number = np.bincount(index[inside], minlength=stretches).astype(float)
    total = [np.bincount(index[inside], column[inside], stretches) for column in error.T]
    number[number == 0] = np.nan
    means: FloatArray = np.column_stack(total) / number[:, None]
    return means


def _clip(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Columns less their medians, clipped at `CLIP` robust deviations, and those deviations."""
    empty = np.isnan(values).all(axis=0)
    safe = np.where(empty, 0.0, values)
    centred = safe - np.nanmedian(safe, axis=0)
    scale = NORMAL * np.nanmedian(np.abs(centred), axis=0)
    scale = np.where(scale > 0, scale, np.inf)
    clipped = np.clip(centred, -CLIP * scale, CLIP * scale)
    return np.where(empty, np.nan, clipped), scale


def _deviations(
    values: FloatArray,
    known: npt.NDArray[np.bool_],
    owner: Rows,
    robots: int,
    scale: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """(robots, columns) z of, and mean deviation from, the median robot; 0 where unknown."""
    hot = np.eye(robots)[owner].T
    number = hot @ known
    enough = number >= LEAST
    mean = np.where(enough, hot @ values / np.maximum(number, 1), np.nan)
    present = enough.sum(axis=0)
    # the median of those present: sorting puts NaN last, and is fast where nanmedian is not
    ranked = np.sort(mean, axis=0)
    middle = np.stack([np.maximum(present - 1, 0) // 2, present // 2]).clip(max=robots - 1)
    centre = np.take_along_axis(ranked, middle, axis=0).mean(axis=0)
    deviation = np.where(enough & (present >= 3), mean - centre, 0.0)
    return deviation * np.sqrt(number) / scale, deviation

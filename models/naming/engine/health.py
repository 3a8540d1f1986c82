"""What sound robots are like: the distribution of every column's coefficient between them.

Learned from healthy logs by expectation-maximisation on each robot's information, so that what a
log does not tell of a robot is not taken for a difference. Causes vary jointly: one wobble that
several terms can see is counted once. Flexible terms vary each by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, stdtrit

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.marginal import (
    EMPTY,
    Prior,
    beside,
    integrated,
    root_of,
    shared,
)
from realitygap.models.naming.rules import Rules

ROUNDS = 40
"""Of expectation-maximisation. No rule: a limit of iterations."""


class Told(NamedTuple):
    """Of the robots of one healthy swarm."""

    names: tuple[str, ...]
    """(k,) of linear columns."""
    information: FloatArray
    """(robots, k, k)."""
    slope: FloatArray
    """(robots, k)."""


@dataclass(frozen=True, eq=False)
class Health:
    """Of every column that healthy robots were measured for."""

    names: tuple[str, ...]
    mean: FloatArray
    """(k,) beyond the reference's motion."""
    covariance: FloatArray
    """(k, k) between robots."""
    swarm: FloatArray
    """(k,) variance between swarms."""
    robots: int
    swarms: int

    def on(self, names: Sequence[str], rules: Rules) -> tuple[Prior, FloatArray]:
        """The prior on a log's columns, and (k,) the standard deviations of what swarms share.

        Of few robots the spread is uncertain: it is widened until chance passes `Rules.few_sure`
        of them as seldom as a normal variable does.
        """
        where = {name: k for k, name in enumerate(self.names)}
        at = np.array([k for k, name in enumerate(names) if name in where], dtype=np.int64)
        own = np.array([where[names[k]] for k in at], dtype=np.int64)
        wide = few(self.robots + rules.believed, rules.few_sure)
        root = root_of(self.covariance[np.ix_(own, own)]) * wide
        spread = np.zeros(len(names))
        spread[at] = np.sqrt(self.swarm[own]) * few(self.swarms + rules.believed, rules.few_sure)
        return Prior(at, self.mean[own], root), spread


def few(count: int, sure: float) -> float:
    """Factor on a standard deviation measured of so many, so that chance passes so many of them as
    seldom as a normal variable does."""
    return float(-stdtrit(count - 1.0, float(ndtr(-sure))) / sure)


def healthy(swarms: Sequence[Told], rules: Rules = Rules()) -> Health:
    """Learn from healthy swarms."""
    believed, alike = rules.believed, rules.alike
    names = tuple(dict.fromkeys(name for one in swarms for name in one.names))
    info, slope = _together(names, swarms)
    swarm = np.repeat(np.arange(len(swarms)), [len(one.slope) for one in swarms])
    size = _usual(np.einsum("rkk->rk", info))
    unit = np.where(size > EMPTY, 1.0 / np.sqrt(np.maximum(size, EMPTY)), 0.0)
    info, slope = info * unit[:, None] * unit, slope * unit
    causes = np.array(["." in name for name in names])
    k, robots, many = len(names), len(slope), len(swarms)
    spread, common = np.eye(k), np.full(k, alike)
    mean = np.zeros(k)
    for _ in range(ROUNDS):
        own = np.linalg.inv(np.linalg.inv(spread) + info)
        bent = own @ info
        w = info - info @ bent
        t = slope - (info @ (own @ slope[:, :, None]))[:, :, 0]
        total, pull = np.zeros((many, k, k)), np.zeros((many, k))
        np.add.at(total, swarm, w)
        np.add.at(pull, swarm, t)
        side = np.sqrt(common)
        lot = side[:, None] * np.linalg.inv(np.eye(k) + side[:, None] * total * side) * side
        known = total - total @ lot @ total
        seen = pull - (total @ (lot @ pull[:, :, None]))[:, :, 0]
        # the mean is believed to be no farther from the reference's motion than one robot of some
        # swarm: what columns cannot tell apart is then given to none of them in excess, and what
        # all swarms do is no difference between them
        like_one = np.diag(1.0 / np.maximum(np.diag(spread) + common, EMPTY))
        mean = np.linalg.solve(known.sum(axis=0) + like_one, seen.sum(axis=0))
        shift = (lot @ (pull - total @ mean)[:, :, None])[:, :, 0]
        moved = (shift**2 + np.einsum("tkk->tk", lot)).sum(axis=0)
        rest = slope - (info @ (mean + shift[swarm])[:, :, None])[:, :, 0]
        u = (own @ rest[:, :, None])[:, :, 0]
        unsure = own + bent @ lot[swarm] @ np.swapaxes(bent, 1, 2)  # of u, its swarm's shift too
        every = u.T @ u + unsure.sum(axis=0) + believed * np.eye(k)
        spread = _shrunk(every / (robots + believed), causes, robots, rules)
        common = (moved + believed * alike * np.diag(spread)) / (many + believed)
    return Health(
        names,
        mean * unit,
        spread * unit[:, None] * unit,
        common * unit**2,
        robots,
        many,
    )


def _usual(information: FloatArray) -> FloatArray:
    """(k,) median of (robots, k) over the robots that say something; 0 where none does."""
    found = np.zeros(information.shape[1])
    for k, one in enumerate(information.T):
        some = one[one > EMPTY]
        found[k] = np.median(some) if len(some) else 0.0
    return found


def _together(names: Sequence[str], swarms: Sequence[Told]) -> tuple[FloatArray, FloatArray]:
    """(robots, k, k) and (robots, k) over all swarms; nothing is known of what a log lacks."""
    where = {name: k for k, name in enumerate(names)}
    robots = sum(len(one.slope) for one in swarms)
    info, slope = np.zeros((robots, len(names), len(names))), np.zeros((robots, len(names)))
    begin = 0
    for one in swarms:
        at = np.array([where[name] for name in one.names])
        here = np.arange(begin, begin + len(one.slope))
        info[np.ix_(here, at, at)] = one.information
        slope[np.ix_(here, at)] = one.slope
        begin += len(here)
    return info, slope


def _shrunk(full: FloatArray, causes: FloatArray, robots: int, rules: Rules) -> FloatArray:
    """A covariance with causes joint, towards none, and everything else by itself."""
    found = np.diag(np.diag(full))
    at = np.flatnonzero(causes)
    block = np.ix_(at, at)
    share = robots / (robots + rules.uncorrelated)
    found[block] = share * full[block] + (1.0 - share) * found[block]
    return found


def farthest(health: Health, swarms: Sequence[Told], rules: Rules = Rules()) -> tuple[float, float]:
    """Largest deviance that one coefficient takes off a healthy robot: of causes, of others."""
    most = np.zeros(2)
    for swarm in swarms:
        prior, spread = health.on(swarm.names, rules)
        scores = [
            integrated(info, slope, 0.0, prior)
            for info, slope in zip(swarm.information, swarm.slope, strict=True)
        ]
        common = shared(scores, spread)
        causes = np.array(["." in name for name in swarm.names])
        for score in scores:
            own = beside(score, common)
            size = np.diag(own.information)
            gain = np.where(size > EMPTY, own.slope**2 / np.maximum(size, EMPTY), 0.0)
            most = np.maximum(most, [gain[causes].max(), gain[~causes].max()])
    return float(most[0]), float(most[1])

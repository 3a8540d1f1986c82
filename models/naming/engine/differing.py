"""By how much the robots of one log differ, where its recording is not the reference's.

Rows that miss commands, filters and other engines make robots look unlike each other that are not:
each meets them as it drives. How much was never measured beforehand, but the log shows it: most
robots of a swarm are sound. What makes most of them differ by more than health does is a further
random effect, found one at a time, the most conspicuous first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import bdtrc, chdtrc, chdtri

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.marginal import EMPTY
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.weighed import Weighed

MOST = 20
"""Random effects that are looked for, and times the robots that are closest are asked for again.
No rule: a limit of iterations."""


def differing(state: State) -> State:
    """The state with the variance between robots that its own log shows.

    Of n robots the gain that the (n // 2 + 1)-th exceeds is compared with chance, so that up to
    half of the robots less one may be ill.
    """
    robots = len(state.robots)
    if robots < 2 * state.rules.least_swarm:  # of fewer one ill robot is too large a part
        return state
    most = robots // 2 + 1
    names = state.robots[0].names
    for _ in range(MOST):
        weighed = Weighed(state)
        gain, size = _gains(weighed, nearest(weighed))
        level = np.sort(gain, axis=0)[robots - most]
        chance = bdtrc(most - 1, robots, chdtrc(1, level))
        eligible = np.isin(np.arange(len(names)), weighed.prior.at)
        chance = np.where(eligible & (level > 0.0), chance, 1.0)
        worst = int(np.argmin(chance))
        if chance[worst] * eligible.sum() >= state.rules.chance:  # one of so many that were tried
            break
        usual = chdtri(1, (most - 0.5) / robots)  # what of sound robots exceeds as often
        extra = (level[worst] / usual - 1.0) / float(np.median(size[:, worst]))
        before = state.between.get(names[worst], 0.0)
        state = replace(
            state,
            between={**state.between, names[worst]: float(np.hypot(before, np.sqrt(extra)))},
        )
    return state


def nearest(weighed: Weighed) -> list[int]:
    """The robots that say what a swarm has in common: more than half, those closest to it.

    One that is far off would else move all the others away from what they share. Of few robots
    none can be told from the rest, and all say it.
    """
    robots = len(weighed.alone)
    near = list(range(robots))
    if robots < 2 * weighed.state.rules.least_swarm:  # of fewer one ill robot is too large a part
        return near
    for _ in range(MOST):
        far = _gains(weighed, near)[0][:, weighed.prior.at].max(axis=1)
        before, near = near, sorted(np.argsort(far, kind="stable")[: robots // 2 + 1].tolist())
        if near == before:
            break
    return near


def _gains(weighed: Weighed, near: list[int]) -> tuple[FloatArray, FloatArray]:
    """(robots, k) deviance that each column takes off each robot beside some, and its
    information."""
    scores = [weighed.beside_some(k, near) for k in range(len(weighed.alone))]
    size = np.array([np.diag(one.information) for one in scores])
    slope = np.array([one.slope for one in scores])
    return np.where(size > EMPTY, slope**2 / np.maximum(size, EMPTY), 0.0), size

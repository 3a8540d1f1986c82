"""Windows that nothing comes near: robust fits set them aside, so that no fit speaks of them.

A few are a tracker's. Where most of them lie in one part of what a robot does, such as its starts,
the robot does something there that no cause describes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.parts import parts


class Wild(NamedTuple):
    """The part of what a robot does in which its windows are wild most of all."""

    part: str
    """Of `motion.parts.PARTS`."""
    inside: float
    """Share of wild windows there."""
    outside: float
    error: float
    """Standard error of the difference, by blocks."""
    share: float
    """Of the squared errors that lies in these windows."""

    @property
    def more(self) -> float:
        """Share of wild windows beyond the rest of the log."""
        return self.inside - self.outside


def wild(problem: Problem) -> Wild | None:
    """Where one robot's windows are wild; None: nowhere in particular.

    Args:
        problem: Of one robot, its base being everything that explains it.
    """
    tracks, rules = problem.tracks, problem.tracks.rules
    errors = problem.residual((), np.zeros((problem.count, 0)))
    errors = errors / problem.spread(errors)[0]
    far = (np.abs(errors) > rules.wild_far).any(axis=1)
    count = np.diff(np.append(tracks.first, len(tracks.rows)))
    out = np.add.reduceat(far.astype(np.float64), tracks.first) / count > rules.wild_rows
    squared = np.add.reduceat((errors**2).sum(axis=1), tracks.first)
    found = []
    for name, inside in parts(tracks).items():
        blocks = [np.unique(tracks.block[side]) for side in (inside, ~inside)]
        if min(len(one) for one in blocks) < rules.wild_blocks:
            continue
        there, elsewhere = float(out[inside].mean()), float(out[~inside].mean())
        error = np.sqrt(
            there * (1.0 - there) / len(blocks[0]) + elsewhere * (1.0 - elsewhere) / len(blocks[1])
        )
        share = float(squared[out & inside].sum() / squared.sum())
        found.append(Wild(name, there, elsewhere, float(error), share))
    clear = [one for one in found if one.more > max(rules.wild_more, rules.errors * one.error)]
    return max(clear, key=lambda one: one.more, default=None)

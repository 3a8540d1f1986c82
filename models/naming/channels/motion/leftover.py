"""What stays unexplained: what follows a measured quantity, and windows that nothing comes near.

Robust fits set aside windows that nothing comes near, so that no fit speaks of them. A few are a
tracker's. Where most of them lie in one part of what a robot does, such as its starts, the robot
does something there that no cause describes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.flexible import CHANNELS, QUANTITIES
from realitygap.models.naming.channels.motion.parts import PARTS, parts
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.findings import Follows, Identified, Uneven


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


def leftover(tracks: Tracks, found: Identified) -> tuple[Unexplained, ...]:
    """What the whole swarm shares, or of each robot where its windows are wild, or the most
    conspicuous of what follows something.

    Beside something unknown that all robots have, nothing can be said of single ones.

    Args:
        tracks: The log's.
        found: What was named, and what follows what.
    """
    said = [_said(one) for one in found.follows if one.whole_swarm]
    said = said or [_uneven(one) for one in found.uneven if one.whole_swarm]
    if said:
        return tuple(said)
    for k in np.unique(tracks.robot).tolist():  # the others were never free
        robot = tracks.robots[k]
        own = [o for o in found.follows if o.robots == (robot,) and not o.whole_swarm]
        aside = wild(Problem(tracks.only([k]), [found.explained[k]]))
        if aside is not None:
            said.append(_set_aside(aside, robot))
        elif own:
            said.append(_said(max(own, key=lambda one: one.distance)))
        else:
            strange = [o for o in found.uneven if o.robots == (robot,) and not o.whole_swarm]
            said += [_uneven(max(strange, key=lambda one: one.where.gain))] if strange else []
    return tuple(said)


def _said(one: Follows) -> Unexplained:
    return Unexplained(
        channel=one.channel,
        share=one.share,
        where=f"{CHANNELS[one.channel]} depending on {QUANTITIES[one.quantity]}",
        quantity=one.quantity,
        robots="all" if one.whole_swarm else one.robots,
        distance=one.distance,
    )


def _uneven(one: Uneven) -> Unexplained:
    return Unexplained(
        channel="motion",
        share=one.where.share,
        where=f"as if its {one.term.cause.name} were {1.0 + one.where.more:.1f} times as large "
        f"{PARTS[one.where.part]} as elsewhere",
        quantity=one.where.part,
        robots="all" if one.whole_swarm else one.robots,
        distance=float(np.sqrt(one.where.gain)),
    )


def _set_aside(found: Wild, robot: int) -> Unexplained:
    """What no fit comes near, in words."""
    return Unexplained(
        channel="speed",
        share=found.share,
        where=f"it moves quite unlike the model {PARTS[found.part]}, in "
        f"{100 * found.inside:.0f} % of these windows ({100 * found.outside:.0f} % elsewhere)",
        quantity=found.part,
        robots=(robot,),
        distance=found.more / max(found.error, 1e-3),
    )

"""What stays unexplained: what follows a measured quantity, and windows that nothing comes near."""

from __future__ import annotations

import numpy as np

from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.flexible import CHANNELS, QUANTITIES
from realitygap.models.naming.channels.motion.parts import PARTS
from realitygap.models.naming.channels.motion.tracks import Tracks
from realitygap.models.naming.channels.motion.wild import Wild, wild
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.findings import Follows, Identified, Uneven


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

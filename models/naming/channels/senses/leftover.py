"""What the senses leave open, in words: what stays unexplained in readings and answers, what would
have shown in them, and what their healthy reference has not measured.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from realitygap.models.belief.catalogue import sense_causes, withheld
from realitygap.models.naming.channels.motion.unmeasured import MEASURE, not_judged, not_named
from realitygap.models.naming.channels.senses.identify import SensesFound
from realitygap.models.naming.channels.senses.quantities import LONGEST, QUANTITIES
from realitygap.models.naming.channels.senses.robot import LATE, TARGETS
from realitygap.models.naming.channels.senses.terms import NO_COMMANDS
from realitygap.models.naming.diagnosis import Detectable, Unexplained
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.findings import Follows
from realitygap.models.naming.health.senses import SenseReference

HOW = {
    "share": "read more or less, by a share of what they read,",
    "counts": "read more or less, by counts,",
    "noise": "scatter more or less",
}
"""By how readings change."""


def leftover(found: SensesFound) -> tuple[Unexplained, ...]:
    """What the whole swarm shares, or each robot has: of each channel what was most conspicuous."""
    said: dict[tuple[str, tuple[int, ...]], Unexplained] = {}
    shared = {_channel(one) for one in found.follows if one.whole_swarm}
    for one in found.follows:
        if one.whole_swarm or _channel(one) not in shared:
            said.setdefault((_channel(one), one.robots), _said(one))
    return tuple(said.values())


def _channel(one: Follows) -> str:
    return one.channel.partition("/")[0]


def _said(one: Follows) -> Unexplained:
    channel, _, change = one.channel.partition("/")
    quantity, _, part = one.quantity.partition(" ")
    return Unexplained(
        channel=channel,
        share=one.share,
        where=_where(channel, change, quantity, part),
        quantity=quantity,
        robots="all" if one.whole_swarm else one.robots,
        distance=one.distance,
    )


def _where(channel: str, change: str, quantity: str, part: str) -> str:
    """What reads otherwise, following what."""
    if channel == "nest":
        return f"it says nest depending on {QUANTITIES[quantity + '_nest']}"
    if quantity == "sensor":
        return f"{channel} sensor {part} reads too much or too little"
    if quantity in ("always", "noise"):
        return f"{channel} sensors {HOW[change]} everywhere and all the time".replace(",", "")
    how = f"{channel} sensors {HOW[change]} depending on {QUANTITIES[quantity]}"
    if quantity == "time" and part:
        return f"{how}, a swing of {LONGEST / float(part.split()[0]):.1f} s"
    return f"{how}, {part}" if quantity == "point" else how


def detectable_in(found: SensesFound) -> tuple[Detectable, ...]:
    """Every cause with a number, by name; of single sensors and robots the worst."""
    robots = found.state.tracks.robots
    result = []
    for name, cause in sense_causes().items():
        if not cause.parameters or cause.kind == "nest" or withheld(name):
            continue
        keys = [f"{name}/{word}" if word else name for word in cause.variants]
        sizes = [found.least[key] for key in keys if key in found.least]
        # where the last number is a strength, the others only say of what
        which = -1 if cause.starts(NO_COMMANDS) else 0
        p = cause.parameters[which]
        if sizes:
            each = np.max([one[:, which] for one in sizes], axis=0)  # (robots,); NaN is the worst
            worst = int(np.argmax(np.where(np.isnan(each), np.inf, each)))
            far = float(each[worst])
        else:
            worst, far = 0, np.nan
        inside = far <= p.bounds[1]
        result.append(
            Detectable(
                cause=name,
                parameter=p.name,
                unit=p.unit,
                null=p.null,
                size=abs(p.value(far) - p.null) if inside else None,
                robot=None if cause.place else robots[worst],
            )
        )
    return tuple(result)


def unmeasured(
    names: Sequence[str], items: Sequence[Item], healthy: SenseReference
) -> tuple[str, ...]:
    """What the log could show and the reference says nothing of.

    Args:
        names: Of the log's columns.
        items: What may be the matter, over them.
        healthy: The reference.
    """
    known = healthy.knows(names)
    unknown = [item for item in items if not known[list(item.columns)].all()]
    keys = {item.key for item in unknown if item.term is not None}
    words = set()
    for item in unknown:
        if item.term is None:
            channel, _, change = item.channel.partition("/")
            quantity = item.quantity.partition(" ")[0]
            if channel != "nest":
                words.add(f"{channel} changes in {change} depending on {QUANTITIES[quantity]}")
    said = [not_named(keys)] if keys else []
    if not healthy.robots:
        return tuple(said)
    if TARGETS not in healthy.columns and {"ir_gain/all.scale", "wall_albedo.scale"} <= set(names):
        said.append(f"ir_gain and wall_albedo of all robots: not told apart; {MEASURE} does it")
    if LATE not in healthy.columns and LATE in names:
        said.append(
            f"clock_offset by the sensors: not told from command_latency; {MEASURE} does it"
        )
    return (*said, *([not_judged(words)] if words else []))

"""What stays unexplained in readings and answers, in words."""

from __future__ import annotations

from realitygap.models.naming.channels.senses.identify import SensesFound
from realitygap.models.naming.channels.senses.quantities import LONGEST, QUANTITIES
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.findings import Follows

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

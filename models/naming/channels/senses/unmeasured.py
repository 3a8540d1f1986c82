"""What a healthy reference of the senses has not measured, in words, as in motion."""

from __future__ import annotations

from collections.abc import Sequence

from realitygap.models.naming.channels.motion.unmeasured import MEASURE, not_judged, not_named
from realitygap.models.naming.channels.senses.quantities import QUANTITIES
from realitygap.models.naming.channels.senses.robot import LATE, TARGETS
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.health.senses import SenseReference


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

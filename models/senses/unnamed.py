"""What is seen without a fit and has no name: the cause that it would be is not in the catalogue.

A sensor that always reads zero, more noise, an edge of the nest elsewhere and walls that read
otherwise while robots do not are seen whether or not anybody has a name for why.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from realitygap.models.causes.withheld import withheld
from realitygap.models.diagnosis import Unexplained
from realitygap.models.naming.findings import Named

SEEN = {
    "ir_dead_sensor": ("infrared", "sensor", "infrared sensor {} reads zero whatever is before it"),
    "ls_dead_sensor": ("light", "sensor", "light sensor {} reads dark whatever light there is"),
    "ir_noise": ("infrared", "noise", "infrared readings scatter otherwise than healthy ones"),
    "wall_albedo": (
        "infrared",
        "target",
        "infrared sensors read walls, and not robots, larger or smaller than expected",
    ),
    "nest_moved": ("nest", "bearing", "it says nest depending on where around the nest it is"),
    "nest_radius": ("nest", "distance", "it says nest nearer to or farther from its middle"),
}
"""By the name it would have: channel, quantity, words."""


def named_or_not(named: Sequence[Named]) -> tuple[tuple[Named, ...], tuple[Unexplained, ...]]:
    """The names that the catalogue has, and the rest as unexplained."""
    kept, left = [], []
    for one in named:
        name = one.term.cause.name
        if withheld(name) and name in SEEN:
            left.append(_left(one, *SEEN[name]))
        else:
            rivals = tuple(t for t in one.evidence.rivals if not withheld(t.cause.name))
            kept.append(replace(one, evidence=replace(one.evidence, rivals=rivals)))
    return tuple(kept), tuple(left)


def _left(one: Named, channel: str, quantity: str, words: str) -> Unexplained:
    return Unexplained(
        channel=channel,
        share=one.evidence.share,
        where=words.format(one.term.variant),
        quantity=quantity,
        robots="all" if one.whole_swarm else one.robots,
        distance=one.evidence.distance,
    )

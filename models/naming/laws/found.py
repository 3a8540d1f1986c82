"""A law that was found in a log, and what speaks for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from realitygap.embedded_sim.laws import Atom, Channel, Quantity


class Amount(NamedTuple):
    """Of one robot, in the channel's unit."""

    value: float
    low: float
    """Of 95 %."""
    high: float


@dataclass(frozen=True, kw_only=True)
class FoundLaw:
    """One form for all its robots, and an amplitude for each."""

    channel: Channel
    of: Quantity
    """What it follows."""
    atoms: tuple[Atom, ...]
    """Of a shape that was not found its curve; none where it cannot be drawn over one quantity."""
    robots: tuple[int, ...]
    """That have it."""
    amounts: Mapping[int, Amount]
    """By robot; empty where there are no atoms."""
    shape: bool
    """Whether its shape was found."""
    whole_swarm: bool
    reading: str
    """What it may mean."""
    gain: float
    """Deviance that it takes off blocks that it was not fitted to, its best fold as the others, of
    at most four robots."""
    ceiling: float
    """The same of the best curve of any quantity."""
    decoy: float
    """The same, at most, of quantities that cannot be behind it."""
    compared: int
    """Other robots of the log that were asked for the same law."""
    instead: tuple[str, ...] = ()
    """Laws that the log cannot tell from it, as equations without an amplitude."""
    errors: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """By key of `claims.ahead.KEYS`, what its robots are off in the mean without and with it."""
    exported: bool = True
    """Whether the extended model holds it."""
    why: str = ""
    """Why not, where it does not."""

"""What was found in a log: causes with values and evidence, and what no cause accounts for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.fitted import Fitted, Key, Values
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.state import State
from realitygap.models.naming.engine.value import Value

Robots = tuple[int, ...]
SURE = 99.0
"""Standard deviations beyond which a distance says no more. No rule: what is told."""


class Where(NamedTuple):
    """Where a cause is of another size than elsewhere."""

    part: str
    """Of `motion.parts.PARTS`."""
    more: float
    """By which it is larger there than elsewhere, in its own size."""
    gain: float
    """Deviance that a size of its own takes off there."""
    share: float
    """Of the deviance that the causes leave."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Evidence:
    """One cause, with what speaks for it."""

    term: Term
    coordinates: FloatArray
    """(p,)."""
    covariance: FloatArray
    """(p, p)."""
    gain: float
    """Deviance that is lost without it, healthy differences integrated out."""
    share: float
    """Of the squared errors without it, what it takes off windows that it was not fitted to."""
    distance: float
    """Standard deviations from the healthy value."""
    rivals: tuple[Term, ...] = ()
    """Terms that could stand in its place."""
    gains: tuple[tuple[str, float], ...] = ()
    """What every term tried in its place would take off, best first."""

    @property
    def score(self) -> float:
        """How far beyond health, as -log10 of what normal tails leave beyond the distance.

        No probability: the best of many terms is told, and the tails of health are not normal.
        """
        return float(-(np.log(2.0) + log_ndtr(-self.distance)) / np.log(10.0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Named:
    """A cause, for whom, how large, why, and what else it could be."""

    term: Term
    robots: Robots
    """Ids of the robots that have it."""
    whole_swarm: bool
    values: tuple[Value, ...]
    given: tuple[Value, ...] = ()
    """What they are told against, such as a healthy robot's acceleration."""
    evidence: Evidence
    twins: tuple[Term, ...]
    """Causes that act exactly alike on what this log holds."""
    exported: bool = True
    """Whether the extended model holds it."""
    why: str = ""
    """Why not, where it does not."""

    @property
    def key(self) -> Key:
        """Of its values in parts of the log."""
        return self.evidence.term, self.robots


@dataclass(frozen=True, eq=False, kw_only=True)
class Follows:
    """A change of motion that follows a measured quantity and that no cause accounts for."""

    channel: str
    quantity: str
    robots: Robots
    whole_swarm: bool
    distance: float
    """Standard deviations from what healthy robots show."""
    gain: float
    """Deviance that it takes off its robots together."""
    share: float
    """Of their squared errors."""


class Uneven(NamedTuple):
    """A cause that was refused, for it would have to be of different sizes in parts of the log."""

    term: Term
    robots: Robots
    whole_swarm: bool
    where: Where


@dataclass(frozen=True, eq=False, kw_only=True)
class Identified:
    """What was found in one log."""

    named: tuple[Named, ...]
    follows: tuple[Follows, ...]
    uneven: tuple[Uneven, ...]
    alike: bool
    """Whether the log was recorded as those of the reference were."""
    recording: tuple[Value, ...] = ()
    """How it was, in numbers; empty: nothing of it was fitted."""
    base: tuple[Motion, ...]
    """(robots,) healthy motion of each robot, as the log was recorded."""
    explained: tuple[Motion, ...]
    """(robots,) motion with every cause named."""
    fits: tuple[Fitted, ...]
    """That the names were taken from: what the swarm shares first, then robot by robot."""
    away: dict[str, FloatArray]
    """(robots,) by channel and quantity, distance from health of what follows it, beside the
    causes."""
    least: dict[str, FloatArray]
    """(robots, p) by key of a term, coordinates from which on it would have been seen; of a limit
    its value."""
    by_part: tuple[Values, Values] = ({}, {})
    """Values of names that were taken from the encoders, as each part of the log gives them."""
    state: State | None = None
    """Of the engine at its end, for laws of what is left; None: nobody asks any more."""

"""A log's robots with what is believed to be the matter with them so far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.engine.subject import Subject
from realitygap.models.naming.rules import Rules

SWARM = -1
"""Scope of what all robots share; others are indices of robots. No rule: a name."""


class Kept(NamedTuple):
    """A cause with its fitted coordinates, or a flexible term."""

    item: Item
    coordinates: FloatArray
    """(p,); empty for a flexible term."""


@dataclass(frozen=True, eq=False)
class State:
    """Everything believed of a log."""

    tracks: Any
    """The log, cut as its channels ask: `Tracks` or `SenseLog`."""
    base: tuple[Any, ...]
    """(robots,) what is believed of healthy ones: `Motion` or `Belief`."""
    robots: tuple[Subject, ...]
    """With every cause kept."""
    health: Health
    kept: dict[int, tuple[Kept, ...]] = field(default_factory=dict)
    """By scope."""
    unsure: Mapping[str, float] = field(default_factory=dict)
    """By name of a column, standard deviation of what the recording of the log adds to what robots
    share."""
    between: Mapping[str, float] = field(default_factory=dict)
    """By name of a column, standard deviation by which robots of this log differ beyond health."""
    refused: frozenset[tuple[int, str]] = frozenset()
    """Scopes with keys of items that are not kept there."""

    @property
    def rules(self) -> Rules:
        rules: Rules = self.tracks.rules
        return rules

    @property
    def items(self) -> tuple[Item, ...]:
        return self.robots[0].items

    def of(self, scope: int) -> tuple[Kept, ...]:
        return self.kept.get(scope, ())

    def members(self, scope: int) -> list[int]:
        """Robots of a scope."""
        return list(range(len(self.robots))) if scope == SWARM else [scope]

    def motion(self, k: int, own: dict[int, Sequence[Kept]]) -> Any:
        """What is believed of a robot with what is kept, some scopes replaced."""
        motion = self.base[k]
        for scope in (SWARM, k):
            for one in own.get(scope, self.of(scope)):
                if one.item.term is not None:
                    motion = self.robots[k].applied(motion, one.item.term, one.coordinates)
        return motion


def refusing(state: State, scope: int, key: str) -> State:
    """The state in which an item is not kept in a scope again."""
    return replace(state, refused=state.refused | {(scope, key)})


def with_kept(state: State, scope: int, kept: Sequence[Kept]) -> State:
    """The state with other beliefs of one scope, its robots moved there."""
    changed = replace(state, kept={**state.kept, scope: tuple(kept)})
    members = set(state.members(scope))
    robots = []
    for k, robot in enumerate(state.robots):
        motion = changed.motion(k, {})
        there = k in members and motion != robot.motion
        robots.append(robot.moved(motion, state.tracks) if there else robot)
    return replace(changed, robots=tuple(robots))

"""A log's robots with what is believed to be the matter with them so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.identify.tracks import Tracks
from realitygap.models.naming.columns import Item
from realitygap.models.naming.health import Health
from realitygap.models.naming.robot import Robot, moved
from realitygap.models.rules import Rules

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

    tracks: Tracks
    base: tuple[Motion, ...]
    """(robots,) healthy."""
    robots: tuple[Robot, ...]
    """At their motions with every cause kept."""
    health: Health
    kept: dict[int, tuple[Kept, ...]] = field(default_factory=dict)
    """By scope."""
    refused: frozenset[tuple[int, str]] = frozenset()
    """Scopes with keys of items that are not kept there."""

    @property
    def rules(self) -> Rules:
        return self.tracks.rules

    @property
    def items(self) -> tuple[Item, ...]:
        return self.robots[0].made.items

    def of(self, scope: int) -> tuple[Kept, ...]:
        return self.kept.get(scope, ())

    def members(self, scope: int) -> list[int]:
        """Robots of a scope."""
        return list(range(len(self.robots))) if scope == SWARM else [scope]

    def motion(self, k: int, own: dict[int, Sequence[Kept]]) -> Motion:
        """A robot's motion with what is kept, some scopes replaced."""
        motion = self.base[k]
        for scope in (SWARM, k):
            for one in own.get(scope, self.of(scope)):
                if one.item.term is not None:
                    cause, variant = one.item.term
                    motion = cause.applied(motion, one.coordinates, variant)
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
        robots.append(moved(robot, motion, state.tracks.commands) if there else robot)
    return replace(changed, robots=tuple(robots))

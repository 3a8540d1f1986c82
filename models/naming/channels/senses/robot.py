"""One robot's senses as naming asks: channels side by side, each white by its own noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.blocks import BLOCK_SECONDS
from realitygap.models.log.held_out import PARTS
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.noise import pose_noise
from realitygap.models.naming.channels.motion.noise import Noise, learn
from realitygap.models.naming.channels.senses.channel import Channel, Part
from realitygap.models.naming.channels.senses.levels import Level, Scatter, targets
from realitygap.models.naming.channels.senses.made import Made
from realitygap.models.naming.channels.senses.nest import Crossings, answers
from realitygap.models.naming.channels.senses.readings import KINDS, Eye, ReadingRows
from realitygap.models.naming.channels.senses.sight import Rows, Sight
from realitygap.models.naming.channels.senses.terms import (
    Doses,
    applied,
    columns_of,
    items_of,
    sense_terms,
)
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.rules import Rules

LATE = "late.seconds"
"""Column of poses that are late against the readings; no cause of the senses."""
TARGETS = "targets.level"
"""Column of what robots reflect more than walls."""
LONG = 10**6
"""Blocks that no run has. No rule: as good as infinite."""
RIDGE_OF_NEST = 1e-3
"""Information that columns of the nest are taken to have: less than one crossing's. No rule: as
good as none."""
LEAST_NEST = 1.0
"""Of how far apart the poses about an edge are, least error of where it is taken to be crossed.
No rule: of what its spread is made."""


@dataclass(frozen=True, eq=False)
class SenseRobot:
    """A robot at what is believed of its senses and of the nest."""

    log: SenseLog
    index: int
    motion: Belief
    """What is believed."""
    items: tuple[Item, ...]
    names: tuple[str, ...]
    parts: tuple[Part, ...]

    @cached_property
    def information(self) -> FloatArray:
        """(k, k)."""
        found = np.zeros((len(self.names), len(self.names)))
        for one in self.parts:
            found[np.ix_(one.at, one.at)] += one.columns.T @ one.columns
        return found

    @cached_property
    def own_errors(self) -> FloatArray:
        """(rows,) white."""
        return self.errors(self.motion)

    @cached_property
    def block(self) -> Rows:
        """(windows,), counted through; -1 where rows are independent, whose errors say so."""
        whole = np.concatenate([np.zeros(0, dtype=np.int64), *(one.block for one in self.parts)])
        found = np.full(len(whole), -1)
        some = whole >= 0
        found[some] = np.unique(whole[some], return_inverse=True)[1]
        return found

    @property
    def rules(self) -> Rules:
        return self.log.rules

    @property
    def learned(self) -> int:
        """Windows that noise was learned from."""
        read = [one for one in self.parts if isinstance(one.channel, ReadingRows)]
        return sum(len(one.channel.first) for one in read)

    def errors(self, motion: Belief) -> FloatArray:
        """(rows,) white, channel after channel."""
        return np.concatenate([np.zeros(0), *(one.errors(motion) for one in self.parts)])

    def pulled(self, rows: FloatArray) -> FloatArray:
        """(p, k) products of (rows, p) white ones with the columns."""
        found = np.zeros((rows.shape[1], len(self.names)))
        for one, mine in self._split(rows):
            found[:, one.at] += mine.T @ one.columns
        return found

    def by_window(self, rows: FloatArray) -> FloatArray:
        """(windows,) sums of (rows,), channel after channel."""
        sums = [
            np.bincount(one.channel.window, mine, len(one.channel.first))
            for one, mine in self._split(rows)
        ]
        return np.concatenate([np.zeros(0), *sums])

    def by_run(self, column: int) -> list[FloatArray]:
        """Of each run, (rows,) a white column there and 0 elsewhere."""
        white = np.zeros(sum(len(one.keep) for one in self.parts))
        each = [one.run[one.channel.window] for one in self.parts]
        run = np.concatenate([np.zeros(0, dtype=np.int64), *each])
        for one, mine in self._split(white):
            at = np.flatnonzero(one.at == column)
            mine[:] = one.columns[:, at[0]] if len(at) else 0.0
        return [np.where(run == k, white, 0.0) for k in np.unique(run)] or [white]

    def applied(self, motion: Belief, term: Term, coordinates: FloatArray) -> Belief:
        """What is believed with a cause."""
        return applied(motion, term, coordinates)

    def moved(self, motion: Belief, tracks: object) -> SenseRobot:
        """The robot at something else, its noise learned anew from it alone."""
        return self.log.at([self.index], [motion])[0]

    def without(self, window: int) -> SenseRobot:
        """The robot as if one window said nothing."""
        parts, begin = [], 0
        for one in self.parts:
            keep = one.keep * (one.channel.window != window - begin)
            parts.append(replace(one, keep=keep))
            begin += len(one.channel.first)
        return replace(self, parts=tuple(parts))

    def of_part(self, part: int) -> SenseRobot:
        """With the rows of one part of the log alone."""
        kept = [replace(one, keep=(self.log.part(one) == part).astype(float)) for one in self.parts]
        return replace(self, parts=tuple(kept))

    def _split(self, rows: FloatArray) -> Iterator[tuple[Part, FloatArray]]:
        begin = 0
        for one in self.parts:
            yield one, rows[begin : begin + len(one.keep)]
            begin += len(one.keep)


class SenseLog:
    """A log's robots, made from what is believed of them."""

    def __init__(
        self,
        log: MeasuredLog,
        model: PointModel,
        sight: Sight | None,
        *,
        of_log: Rows,
        doses: Doses | None = None,
        robots_seen: bool = True,
        rules: Rules = Rules(),
    ) -> None:
        """Prepare.

        Args:
            log: Measured.
            model: What the simulator believes.
            sight: The log cut for its sensors; None: they are not judged.
            of_log: (rows,) part of the log of each of its rows.
            doses: Whole ones that are tried beside the catalogue's.
            robots_seen: Whether readings of other robots count: health says what these reflect.
            rules: What naming is tuned to.
        """
        self.rules = rules
        self.step = log.step
        self.sight, self.model, self.doses = sight, model, doses or {}
        self.robots = tuple(int(r) for r in np.unique(log.frame["robot"].to_numpy(dtype=np.int64)))
        self._part = of_log
        self._names: tuple[str, ...] = ()
        self._items: tuple[Item, ...] = ()
        if sight is not None:
            self.robots = sight.robots
            self._eyes = [Eye(sight.of(k), model) for k in range(len(self.robots))]
        self._targets: list[Level | None] = []
        if sight is not None and robots_seen:
            self._targets = [targets(eye.sight, model) for eye in self._eyes]
        seen = answers(log)
        self._nest: list[Crossings] = []
        if seen is not None:
            noise = pose_noise(log, replay_log(log, model.drive)).position
            self._nest = [Crossings(seen, robot, model, noise) for robot in self.robots]

    def part(self, one: Part) -> Rows:
        """(n,) part of the log of each row of a channel, -1 where it is of neither."""
        channel = one.channel
        if isinstance(channel, ReadingRows):
            return np.asarray(channel.eye.sight.part[channel.moments][channel.window])
        if isinstance(channel, Crossings):
            return np.asarray(self._part[channel.rows])
        return np.full(len(channel.window), channel.part if isinstance(channel, Level) else -1)

    def at(self, which: Sequence[int], beliefs: Sequence[Belief]) -> list[SenseRobot]:
        """Some robots at what is believed of each."""
        each: list[list[tuple[Channel, Made, Noise]]] = [[] for _ in which]
        for name in KINDS if self.sight is not None else ():
            channels = [
                ReadingRows(self._eyes[k], name, b) for k, b in zip(which, beliefs, strict=True)
            ]
            some = [i for i, one in enumerate(channels) if len(one.window)]
            if not some:
                continue
            made = [self._of_readings(channels[i], beliefs[i]) for i in some]
            cut = [channels[i] for i in some]
            noise = learn(cut, [one.columns for one in made], self.rules, free=0, restricted=True)
            for i, columns, own in zip(some, made, noise, strict=True):
                each[i].append((channels[i], columns, own))
        for i, (k, belief) in enumerate(zip(which, beliefs, strict=True)):
            each[i] += self._levels(k, belief, each[i])
            each[i] += self._crossings(k, belief)
        return self._joined(which, beliefs, each)

    def _of_readings(self, channel: ReadingRows, belief: Belief) -> Made:
        made = self._of_causes(channel, belief)
        made.add(None, {LATE: channel.late()})
        for change, (quantity, part), values in channel.flexible():
            made.flexible(f"{channel.name}/{change}", quantity, part, values)
        made.windows = channel.effects()
        return made

    def _levels(
        self, k: int, belief: Belief, found: Sequence[tuple[Channel, Made, Noise]]
    ) -> list[tuple[Channel, Made, Noise]]:
        """How the readings scatter, and what robots reflect."""
        levels: list[Level | None] = []
        for channel, _, noise in found:
            if isinstance(channel, ReadingRows) and channel.name == "infrared":
                both = [Scatter(channel, noise.left[:, 0], belief, part) for part in range(PARTS)]
                levels += [one for one in both if one.enough]
        levels += self._targets[k : k + 1]
        told: list[tuple[Channel, Made, Noise]] = []
        for one in levels:
            if one is not None:
                made = self._of_causes(one, belief)
                per = np.array([one.per_unit])
                if one.name == "targets":
                    made.add(None, {TARGETS: per})
                else:
                    made.flexible("infrared/noise", "noise", "", per)
                told.append((one, made, Noise(np.ones((1, 1)), np.ones(1), np.zeros(0))))
        return told

    def _crossings(self, k: int, belief: Belief) -> list[tuple[Channel, Made, Noise]]:
        """Where the robot crossed the nest's edge."""
        if not self._nest or not len(self._nest[k].rows):
            return []
        channel = self._nest[k]
        made = self._of_causes(channel, belief)
        around, per = channel.bearing(), 1.0 / channel.sd
        made.flexible("nest/edge", "distance", "", per)
        for turns, word in ((1, ""), (2, " twice")):
            made.flexible("nest/edge", "bearing", f" sin{word}", per * np.sin(turns * around))
            made.flexible("nest/edge", "bearing", f" cos{word}", per * np.cos(turns * around))
        (noise,) = learn(
            [channel], [made.columns], self.rules, free=0, least=LEAST_NEST, ridge=RIDGE_OF_NEST
        )
        return [(channel, made, noise)]

    def _of_causes(self, channel: Channel, belief: Belief) -> Made:
        made = Made(channel.errors(belief))
        for term in sense_terms():
            cause = term.cause
            assert isinstance(cause, SenseCause)
            if cause.kind in channel.kinds:
                for item, names in items_of(term, self.doses):
                    columns = columns_of(item, belief, channel.errors)
                    made.add(item, dict(zip(names, columns, strict=True)))
        return made

    def _joined(
        self,
        which: Sequence[int],
        beliefs: Sequence[Belief],
        each: Sequence[Sequence[tuple[Channel, Made, Noise]]],
    ) -> list[SenseRobot]:
        if not self._names:  # all robots are asked for first
            every = [one for channels in each for _, one, _ in channels]
            self._names = tuple(dict.fromkeys(name for one in every for name in one.values))
            where = {name: k for k, name in enumerate(self._names)}
            found_items = {key: kind for one in every for key, kind in one.items.items()}
            self._items = tuple(one.over(where) for one in found_items.values())
        names, items = self._names, self._items
        where = {name: k for k, name in enumerate(names)}
        found = []
        for k, belief, channels in zip(which, beliefs, each, strict=True):
            parts = []
            for channel, made, noise in channels:
                made.only(where)
                at = np.array([where[name] for name in made.values], dtype=np.int64)
                block, run = _times(channel)
                keep = np.ones(len(channel.window))
                parts.append(Part(channel, at, made.columns, noise, block, run, keep))
            found.append(SenseRobot(self, k, belief, items, names, tuple(parts)))
        return found


def _times(channel: Channel) -> tuple[Rows, Rows]:
    """(windows,) block of time, and run, of each window."""
    if isinstance(channel, ReadingRows):
        sight, at = channel.eye.sight, channel.moments
        return sight.run[at] * LONG + (sight.time[at] / BLOCK_SECONDS).astype(np.int64), sight.run[
            at
        ]
    none = np.full(len(channel.first), -1)
    return none, channel.run if isinstance(channel, Crossings) else none

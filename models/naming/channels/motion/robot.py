"""One robot's windows at given motions: columns, noise, and what they say of every coefficient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion
from realitygap.models.naming.channels.motion.columns import CLOCK, Columns, columns
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.noise import Noise, Whitener, learn
from realitygap.models.naming.channels.motion.tracks import Rows, Tracks
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item


@dataclass(frozen=True, eq=False)
class Robot:
    """Of a log."""

    tracks: Tracks
    """Of this robot alone."""
    motion: Motion
    """At which the columns were made."""
    made: Columns
    noise: Noise

    @property
    def items(self) -> tuple[Item, ...]:
        return self.made.items

    @property
    def names(self) -> tuple[str, ...]:
        """(k,) of columns."""
        return self.made.names

    @property
    def block(self) -> Rows:
        """(windows,) block of each window."""
        return self.tracks.block

    @cached_property
    def white(self) -> Whitener:
        return Whitener(self.tracks, self.made.windows, self.noise)

    @cached_property
    def columns(self) -> FloatArray:
        """(rows, k) white."""
        return self.white(self.made.values)

    @cached_property
    def information(self) -> FloatArray:
        """(k, k)."""
        return np.asarray(self.columns.T @ self.columns)

    @property
    def scatter(self) -> float:
        """s, standard deviation of every window's own time; 0 where its causes are withheld."""
        spread = self.noise.spread
        return float(spread[CLOCK]) if len(spread) > CLOCK + 1 else 0.0

    def pulled(self, rows: FloatArray) -> FloatArray:
        """(p, k) products of (rows, p) white ones with the columns."""
        return np.asarray(rows.T @ self.columns)

    def by_window(self, rows: FloatArray) -> FloatArray:
        """(windows,) sums of (rows,) over each window."""
        return np.add.reduceat(rows, 3 * self.tracks.first)

    def by_run(self, column: int) -> list[FloatArray]:
        """Of each run, (rows,) a white column there and 0 elsewhere."""
        run = np.repeat(self.tracks.row_segment[self.tracks.rows], 3)
        white = self.columns[:, column]
        return [np.where(run == one, white, 0.0) for one in np.unique(run)]

    def applied(self, motion: Motion, term: Term, coordinates: FloatArray) -> Motion:
        """A motion with a cause."""
        return term.cause.applied(motion, coordinates, term.variant)

    def without(self, window: int) -> Robot:
        """The robot as if one window said nothing."""
        keep = (self.tracks.window != window).astype(np.float64)
        return replace(self, noise=replace(self.noise, weight=self.noise.weight * keep[:, None]))

    def moved(self, motion: Motion, tracks: Tracks) -> Robot:
        """The robot at another motion, its noise learned anew from it alone.

        Args:
            motion: The other.
            tracks: Of the whole log.
        """
        made = columns(self.tracks, [motion], tracks.commands)
        (noise,) = learn([self.tracks], [made], tracks.rules)
        return Robot(self.tracks, motion, made, noise)

    def errors(self, motion: Motion) -> FloatArray:
        """(rows,) white errors at any motion."""
        problem = Problem(self.tracks, [motion])
        rows = problem.residual((), np.zeros((1, 0)))
        return np.asarray(self.white(rows[:, :, None])[:, 0])

    @cached_property
    def own_errors(self) -> FloatArray:
        """(rows,) white errors at its motion."""
        return np.asarray(self.white(self.made.errors[:, :, None])[:, 0])


def robots_of(tracks: Tracks, motions: Sequence[Motion], *, doses: bool = True) -> list[Robot]:
    """Every robot of a log, with noise learned of all together; `doses` as of `columns`."""
    each = [tracks.only([k]) for k in range(len(tracks.robots))]
    whole = columns(tracks, motions, tracks.commands, doses=doses)
    edge = np.searchsorted(tracks.robot[tracks.window], np.arange(len(each) + 1)).tolist()
    made = [whole.of(slice(begin, end)) for begin, end in pairwise(edge)]
    noise = learn(each, made, tracks.rules)
    return [Robot(*one) for one in zip(each, motions, made, noise, strict=True)]

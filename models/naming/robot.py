"""One robot's windows at given motions: columns, noise, and what they say of every coefficient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.causes import Motion
from realitygap.models.identify.fit import Problem
from realitygap.models.identify.tracks import Tracks
from realitygap.models.naming.columns import Columns, columns
from realitygap.models.naming.noise import Noise, Whitener, learn


@dataclass(frozen=True, eq=False)
class Robot:
    """Of a log."""

    tracks: Tracks
    """Of this robot alone."""
    motion: Motion
    """At which the columns were made."""
    made: Columns
    noise: Noise

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
    made = [
        columns(one, [m], tracks.commands, doses=doses)
        for one, m in zip(each, motions, strict=True)
    ]
    noise = learn(each, made)
    return [Robot(*one) for one in zip(each, motions, made, noise, strict=True)]


def moved(robot: Robot, motion: Motion, commands: FloatArray) -> Robot:
    """The robot at another motion, its noise learned anew from it alone."""
    made = columns(robot.tracks, [motion], commands)
    (noise,) = learn([robot.tracks], [made])
    return Robot(robot.tracks, motion, made, noise)

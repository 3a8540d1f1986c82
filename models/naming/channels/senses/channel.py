"""One robot's rows of one channel, with their columns and their noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.naming.channels.motion.columns import Columns
from realitygap.models.naming.channels.motion.noise import Noise, Whitener
from realitygap.models.naming.channels.senses.sight import Rows


class Channel(Protocol):
    """Some rows of one robot, at what is believed of it."""

    @property
    def name(self) -> str: ...
    @property
    def kinds(self) -> tuple[str, ...]:
        """Of the causes that show in it."""

    @property
    def window(self) -> Rows:
        """(n,) window of each row."""

    @property
    def first(self) -> Rows:
        """(windows,) first row of each."""

    def errors(self, belief: Belief) -> FloatArray:
        """(n,) in noise if something is believed."""


@dataclass(frozen=True, eq=False)
class Part:
    """One channel of one robot with its columns and its noise."""

    channel: Channel
    at: Rows
    """(k',) columns that it shows among the robot's."""
    made: Columns
    noise: Noise
    block: Rows
    """(windows,) block of time of each window."""
    run: Rows
    """(windows,) of each window."""
    keep: FloatArray
    """(n,) 1 where rows count, 0 where they are in another part of the log."""

    @cached_property
    def _white(self) -> Whitener:
        return Whitener(self.channel, self.made.windows, self.noise, free=0)

    def white(self, rows: FloatArray) -> FloatArray:
        """(n, k) white ones of (n, k)."""
        return self._white(rows[:, None, :]) * self.keep[:, None]

    @cached_property
    def columns(self) -> FloatArray:
        """(n, k') white."""
        return self.white(self.made.values[:, 0, :])

    def errors(self, belief: Belief) -> FloatArray:
        """(n,) white."""
        return self.white(self.channel.errors(belief)[:, None])[:, 0]

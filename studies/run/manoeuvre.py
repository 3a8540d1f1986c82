"""Robots that perform a manoeuvre of the menu instead of foraging."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.onboard import Flags, Generation
from realitygap.embedded_sim.pilot import Pilot
from realitygap.embedded_sim.probes import probe


class Manoeuvre:
    """Robots under a pilot: nothing evolves, and no food is taken."""

    def __init__(self, name: str, robots: int, model: PointModel) -> None:
        """Plan it by what is believed of robot and arena.

        Raises:
            InputError: there is no such manoeuvre, or so many robots do not find room for it.
        """
        self._pilot = Pilot(probe(name), robots, model)
        self.carrying: Flags = np.zeros(robots, dtype=np.uint8)
        self.generations: list[Generation] = []
        self.deposits: list[tuple[int, int, int, int]] = []

    @property
    def starts(self) -> FloatArray:
        """(robots, 3) m, m, rad where the robots are put down by hand."""
        return self._pilot.starts

    @property
    def commands(self) -> FloatArray:
        """(robots, 2) rad/s, left and right."""
        return self._pilot.commands

    def follow(self, poses: FloatArray) -> None:
        """Set the commands where the tracker sees the robots at `poses` (robots, 3)."""
        self._pilot.step(poses)

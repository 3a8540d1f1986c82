"""What a cause is: a name, its physics, its parameters, and how they enter a robot's motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.motion import Motion

Link = Literal["add", "factor"]
ALL = ""
"""The variant of a cause that has only one."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One number of a cause, with the name it has in an `--effect`.

    It is fitted in a coordinate that is 0 at the null (`add`: value = null + coordinate;
    `factor`: value = null * exp(coordinate)), or, without a null, equals the value.
    """

    name: str
    unit: str
    null: float
    """Value at which nothing is changed; may be infinite."""
    low: float
    """Least value believed."""
    high: float
    """Largest value believed."""
    step: float
    """Coordinate's step for finite differences: a small but clearly visible change."""
    link: Link = "add"
    sign: int = 0
    """Side of the null on which the cause lies: 1 above, -1 below, 0 either. On the other side it
    is fitted, to be fair to the null, but never named."""
    doubt: float = 0.0
    """Standard error of what the point model's term is worth in the physical unit, relative to the
    coordinate: a rigid body on a floor is not exactly a point on two wheels."""

    unsure: float = 0.0
    """Standard error of the coordinate that no log takes away, as of a place that tables tell."""

    @property
    def zero(self) -> float:
        """Null that coordinates count from."""
        return self.null if math.isfinite(self.null) else 0.0

    def value(self, coordinate: float) -> float:
        """The physical value at a coordinate."""
        if self.link == "factor":
            return self.null * math.exp(coordinate)
        return self.zero + coordinate

    def coordinate(self, value: float) -> float:
        """The coordinate of a physical value."""
        return math.log(value / self.null) if self.link == "factor" else value - self.zero

    @property
    def bounds(self) -> tuple[float, float]:
        """Coordinates of the least and the largest value."""
        return self.coordinate(self.low), self.coordinate(self.high)

    def kept(self, value: float) -> float:
        """The believed value nearest to a value, which may be infinite."""
        return min(max(value, self.low), self.high)

    def believed(self, coordinate: float) -> float:
        """The believed value nearest to that at a coordinate, which may be infinite."""
        least, most = self.bounds
        return self.kept(self.value(min(max(coordinate, least), most)))


Change = Callable[[Motion, FloatArray, str], Motion]
Starts = Callable[[FloatArray], list[FloatArray]]


@dataclass(frozen=True)
class FixedStarts:
    """The same starts whatever was commanded."""

    coordinates: tuple[float, ...] = ()

    def __call__(self, commands: FloatArray) -> list[FloatArray]:
        return [np.array([one]) for one in self.coordinates]


@dataclass(frozen=True, kw_only=True)
class Cause:
    """A physical reason why a robot does not move as simulated."""

    name: str
    meaning: str
    """What is the matter with the robot, in words for the person who must repair it."""
    parameters: tuple[Parameter, ...]
    plain: str = ""
    """The same in a plain sentence with its numbers, and what to do about it. In braces: `Whose`
    robots (`whose` within the sentence), `which` wheel or sensor, and a parameter: its value, or
    after a colon a share (`%`), or by how much it departs from its null and words for the two sides
    (`larger/smaller`). Every cause of the catalogue has one."""
    change: Change
    """(motion, values (parameters [+ given],), variant) -> motion with the cause. At the null: the
    same."""
    given: tuple[Parameter, ...] = ()
    """What the values are told against, such as a healthy robot's acceleration: not fitted, told
    beside them, and asked for where the cause is read from a file."""
    told_against: Callable[[Motion], FloatArray] | None = None
    """(healthy motion) -> values (given,); infinite where not known, and then nothing is told."""
    place: bool = False
    """It belongs to the arena, not to a robot: every robot has it or none."""
    variants: tuple[str, ...] = (ALL,)
    """Words of the parameter `word`, such as which wheel."""
    word: str = ""
    """Name of the parameter that takes a word instead of a number; empty: none."""
    where: str = ""
    """The kind of drive (`[robot] drive_kind`) that it has a meaning for, or `unmeasured`: tried
    only where no reference says how healthy robots move; empty: tried always."""
    columns: tuple[str, ...] = ()
    """Columns of the log beyond poses and commands without which it cannot be seen."""
    confusable_with: tuple[str, ...] = ()
    family: str = ""
    """Causes of one family shape the same moments of a path: one that is only roughly right leaves
    errors that another seems to explain."""
    feigns: Mapping[str, float] = field(default_factory=dict, hash=False)
    """By name of another cause, standard deviation of what a robot with this one seems to have of
    that, in its coordinate: the point model's term is only roughly what happens on the floor."""
    exact: bool = False
    """The term does just what the cause does: what a fit asks for of the causes that it feigns only
    bends its value, and mends nothing."""
    twins: tuple[str, ...] = ()
    """Causes that act on poses exactly alike; `separated_by` tells them apart."""
    as_twin: Callable[[Motion, Motion], float | None] | None = None
    """(motion without, motion with a twin) -> the own parameter's value that moves poses alike, or
    None where it cannot have one. Of the twins that do not stand for the others in the search."""
    separated_by: tuple[str, ...] = ()
    """Columns that tell a cause from its twins."""
    experiment: str = ""
    """Manoeuvre of the menu (`embedded_sim.probes`) that shows it best."""
    identifiable: bool = True
    """False: known, but not visible enough in motion to be named."""
    bends: bool = False
    """Its effect bends within a step of a parameter: derivatives are taken from both sides."""
    smooth: bool = True
    """False: the fit must scan the first parameter, whose effect jumps."""
    starts: Starts = FixedStarts()
    """Coordinates (parameters,) to start the fit from besides the null, given the commands."""

    def applied(self, motion: Motion, coordinates: FloatArray, variant: str = ALL) -> Motion:
        """The motion with this cause at the given coordinates, kept within bounds."""
        return self.change(motion, self.values(coordinates), variant)

    def values(self, coordinates: FloatArray) -> FloatArray:
        """(parameters,) values at coordinates, kept within bounds."""
        pairs = zip(self.parameters, coordinates.tolist(), strict=True)
        return np.array([p.believed(u) for p, u in pairs])


def sides(variant: str) -> tuple[bool, bool]:
    """Which wheels (left, right) a variant `left`, `right` or `both` means."""
    return variant in ("left", "both"), variant in ("right", "both")

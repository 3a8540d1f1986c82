"""What a cause in the senses is: as a cause in motion, with a term of the point model's senses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Protocol

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.senses import Senses
from realitygap.models.belief.cause import ALL, Cause, Change
from realitygap.models.belief.motion import Motion
from realitygap.models.log.schema import LS, PS

SENSORS_OR_ALL = ("all", *(str(k) for k in range(len(PS))))
"""Words of a cause that concerns one sensor or all eight."""
ONE_SENSOR = SENSORS_OR_ALL[1:]
KEPT = 256
"""Point models of 0.1 MB that are kept: a diagnosis asks each robot for the same hundred."""


class Memory(Protocol):
    """A term that needs what a sensor read before. It can be hashed, as a frozen dataclass can."""

    @property
    def reach(self) -> tuple[float, float]:
        """s after which what infrared and light read before matters no more. So long after another
        robot was in the way, whose effect nobody predicts, readings do not count."""

    def __call__(self, counts: FloatArray, time: FloatArray) -> FloatArray:
        """What is read instead.

        Args:
            counts: (rows, 16) that one robot would read without it in one run, ps0..ps7, ls0..ls7.
            time: (rows,) s since the run began, rising; rows that the tracker missed are absent.

        Returns:
            (rows, 16) counts.
        """


@dataclass(frozen=True, kw_only=True)
class Belief:
    """What is believed of one robot's senses and task; the defaults are the minimal model."""

    senses: Senses = field(default_factory=Senses)
    memory: tuple[Memory, ...] = ()
    """One after the other on what `senses` reads. Diagnosis alone knows it: no simulator does."""
    nest_shift: tuple[float, float] = (0.0, 0.0)
    """m."""
    nest_scale: float = 1.0

    def sensing(self, **changes: Any) -> Belief:
        """The belief with some of its senses' fields changed."""
        return replace(self, senses=replace(self.senses, **changes))

    def of(self, model: PointModel) -> PointModel:
        """The point model as believed of this robot."""
        return _with(model, self.senses, self.nest_shift, self.nest_scale)


@lru_cache(maxsize=KEPT)
def _with(
    model: PointModel, senses: Senses, shift: tuple[float, float], scale: float
) -> PointModel:
    """A point model with other senses and another nest: one, however many robots it is asked for,
    for what C has of it is made only once."""
    x, y, radius = model.nest
    return replace(model, senses=senses, nest=(x + shift[0], y + shift[1], radius * scale))


Sensing = Callable[[Belief, FloatArray, str], Belief]
Leaps = Callable[[], list[FloatArray]]


def nowhere() -> list[FloatArray]:
    """No leaps."""
    return []


def unmoved(motion: Motion, values: FloatArray, variant: str) -> Motion:
    """No sensor moves a robot otherwise than its controller does, and that is in the commands."""
    return motion


@dataclass(frozen=True, kw_only=True)
class SenseCause(Cause):
    """A physical reason why sensors or the virtual sensor do not read as simulated."""

    sense: Sensing
    """(belief, values (parameters,), variant) -> belief with the cause. At the null: the same."""
    kind: str
    """What shows it: `ps`, `ls`, `both`, `noise` (how infrared scatters) or `nest`."""
    leaps: Leaps = field(default=nowhere)
    """Coordinates (parameters,) far from the null that are tried as they are: from the null a step
    does not lead to a lamp that stands elsewhere altogether. Of causes of the place only."""
    change: Change = field(default=unmoved)
    bends: bool = True
    """Readings of a wall that is near bend within a degree and a millimetre."""

    def __post_init__(self) -> None:
        """All that changes a lamp's light is of one family: what is left of one that is not quite
        exact looks like another."""
        if self.kind == "ls":
            object.__setattr__(self, "family", "light")

    def believed(self, belief: Belief, coordinates: FloatArray, variant: str = ALL) -> Belief:
        """The belief with this cause at the given coordinates, kept within bounds."""
        return self.sense(belief, self.values(coordinates), variant)


def chosen(variant: str) -> list[int]:
    """Indices of the sensors that a word means."""
    return list(range(len(PS))) if variant == "all" else [int(variant)]


__all__ = ["LS", "ONE_SENSOR", "PS", "SENSORS_OR_ALL", "Belief", "Memory", "SenseCause", "chosen"]

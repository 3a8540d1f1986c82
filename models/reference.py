"""The healthy reference: what healthy robots do beyond the model, and how much they differ.

Made from logs of robots known to be sound. It holds the inherent motion
(`models.identify.inherent`), for every term of the catalogue the value that healthy robots and
whole healthy swarms get for it, and the gates: how large a gain and how far a parameter must be
beyond what health gives. What is named later is what changed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np
from pydantic import Field, model_validator

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.catalogue import every_cause
from realitygap.models.causes import Motion
from realitygap.models.files import Finite, Refused, read_json, write_json
from realitygap.models.identify.inherent import INHERENT

DIRECTORY = Path(__file__).parent / "references"
SCHEMA = 1


class Spread(Finite):
    """What healthy robots get for a term: coordinates (p,), see `models.causes.Parameter`."""

    mean: tuple[float, ...]
    sd: tuple[float, ...]
    """Between robots, their own uncertainty taken off."""
    swarm_mean: tuple[float, ...]
    swarm_sd: tuple[float, ...]
    """Between whole swarms (runs)."""
    farthest: float
    """Largest distance, in standard deviations, of a healthy robot."""
    swarm_farthest: float

    def coordinates(self, *, swarm: bool) -> tuple[FloatArray, FloatArray]:
        """(p,) mean and standard deviation, between robots or between whole swarms."""
        if swarm:
            return np.array(self.swarm_mean), np.array(self.swarm_sd)
        return np.array(self.mean), np.array(self.sd)


def check_sizes(terms: Mapping[str, Spread], *, seldom: bool = False) -> None:
    """Refuse a term with another number of coordinates than its cause has.

    One of a cause that the catalogue does not have is left alone. With `seldom` a term may have
    been measured of robots alone or of swarms alone.
    """
    for key, spread in terms.items():
        cause = every_cause().get(key.partition("/")[0])
        size = len(spread.mean) if cause is None else len(cause.parameters)
        for name in ("mean", "sd", "swarm_mean", "swarm_sd"):
            found = len(getattr(spread, name))
            if found != size and not (seldom and found == 0):
                raise Refused(f"terms.{key}.{name}", f"{found} numbers", f"{size} numbers")


class Structure(Finite):
    """What healthy robots get for a flexible term (`models.identify.structure`)."""

    mean: float
    sd: float
    """Between robots, their own uncertainty taken off."""
    swarm_sd: float
    farthest: float
    """Largest distance, in standard deviations, of a healthy robot."""
    swarm_farthest: float


UNKNOWN = Structure(mean=0.0, sd=0.0, swarm_sd=0.0, farthest=0.0, swarm_farthest=0.0)
"""Where there is no reference at all, whatever follows something is beyond the model."""


class Gates(Finite):
    """What a name needs beyond what healthy robots show."""

    gain: float = 12.0
    """Held-out deviance that a term must take off: odds of 400 to 1."""
    distance: float = 4.5
    """Standard deviations from the healthy value, spread and uncertainty together: one in 10 000
    healthy robots over the whole catalogue. Where healthy robots went further for a term, more."""
    margin: float = 1.25
    """Times the farthest healthy robot."""
    structure: float = 6.0
    """Standard deviations from health that a flexible term needs to be called unexplained: one in
    ten million healthy robots by chance alone, because the tails of some sixty terms are not."""


class Reference(Finite):
    """What is believed of healthy robots."""

    schema_version: int = SCHEMA
    model: str
    """Name in the model file it was made with."""
    wheel_radius: float
    axle: float
    """m, of that model."""
    robots: int
    swarms: int
    """Healthy robots and runs it was made from."""
    inherent: tuple[float, ...]
    """Coordinates of `models.identify.inherent.INHERENT`."""
    terms: dict[str, Spread] = Field(default_factory=dict)
    structure: dict[str, Structure] = Field(default_factory=dict)
    gates: Gates = Gates()
    command: str = ""
    """What made it."""
    inputs: tuple[dict[str, str], ...] = ()
    """The files it was made from: `option`, `file`, `sha256`."""

    @model_validator(mode="after")
    def _sized(self) -> Reference:
        """Refuse coordinates of other terms than ours."""
        if len(self.inherent) != len(INHERENT.parameters):
            expected = f"{len(INHERENT.parameters)} numbers"
            raise Refused("inherent", f"{len(self.inherent)} numbers", expected)
        check_sizes(self.terms)
        return self

    def motion(self, believed: Motion) -> Motion:
        """A healthy robot's motion where the model believes another."""
        if not self.robots:
            return believed
        return INHERENT.applied(believed, np.array(self.inherent))

    def knows(self, key: str) -> bool:
        """Whether a term was measured in healthy robots, or health is not asked for at all."""
        return not self.robots or key in self.terms

    def gate(self, key: str, *, swarm: bool = False) -> float:
        """Distance from health that a term needs; infinite where health is not known."""
        if not self.knows(key):
            return math.inf
        if key not in self.terms:
            return self.gates.distance
        found = self.terms[key]
        farthest = found.swarm_farthest if swarm else found.farthest
        return max(self.gates.distance, self.gates.margin * farthest)

    def health(self, key: str) -> Structure | None:
        """What healthy robots get for a flexible term; None: it was not measured."""
        return self.structure.get(key) if self.robots else UNKNOWN

    def spread(self, key: str, size: int, *, swarm: bool = False) -> tuple[FloatArray, FloatArray]:
        """(p,) healthy mean and standard deviation of a term's coordinates.

        The latter is infinite where healthy robots were measured and this term was not, and 0 where
        none were: the model is then taken for health.
        """
        if key not in self.terms:
            return np.zeros(size), np.full(size, 0.0 if self.knows(key) else math.inf)
        return self.terms[key].coordinates(swarm=swarm)


def write_reference(reference: Reference, path: Path) -> None:
    """Write as JSON, numbers at full precision."""
    write_json(reference, path)


def read_reference(path: Path) -> Reference:
    """Read a reference file.

    Raises:
        InputError: there is no such file, or it is not a reference.
    """
    what = "a healthy reference of `realitygap reference`, or none"
    return read_json(Reference, path, what, field="--reference")


def shipped_reference(model: str, *, manoeuvres: bool = False) -> Reference | None:
    """The reference that comes with the package for a model of this name; None: there is none.

    With `manoeuvres` that of robots which stop and reverse, where there is one.
    """
    return find_shipped(DIRECTORY, read_reference, model, manoeuvres=manoeuvres)


class _OfModel(Protocol):
    @property
    def model(self) -> str:
        """Name in the model file it was made with."""


Kept = TypeVar("Kept", bound=_OfModel)


def find_shipped(
    directory: Path, read: Callable[[Path], Kept], model: str, *, manoeuvres: bool
) -> Kept | None:
    """The first reference for a model of this name in a directory; None: there is none.

    With `manoeuvres` the directory's folder of that name is looked at first.
    """
    for folder in ([directory / "manoeuvres"] if manoeuvres else []) + [directory]:
        for reference in map(read, sorted(folder.glob("*.json"))):
            if reference.model == model:
                return reference
    return None


def no_reference(model: str, drive: Drive) -> Reference:
    """What is believed where nobody measured healthy robots: the minimal model, no spread."""
    return Reference(
        model=model,
        wheel_radius=float(np.mean(drive.wheel_radius)),
        axle=drive.axle,
        robots=0,
        swarms=0,
        inherent=(0.0,) * len(INHERENT.parameters),
    )

"""The healthy reference of the senses: what healthy robots' readings do beyond the model.

As the reference of motion: an inherent part, and for every term the value that healthy robots and
whole healthy swarms get for it. It is a file of its own beside the motion's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pydantic import Field, model_validator

from realitygap.embedded_sim.errors import nearest, quoted
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.catalogue import every_cause
from realitygap.models.files import Finite, Refused, read_json, write_json
from realitygap.models.reference import find_shipped
from realitygap.models.senses.cause import Belief
from realitygap.models.senses.causes import sense_causes

DIRECTORY = Path(__file__).parents[1] / "references" / "senses"
SCHEMA = 1
SWARM_MORE = 0.7
"""Standard deviations more that a term of the whole swarm must be from health: fewer healthy swarms
than robots were seen."""
INHERENT = ("ir_offset", "lamp_intensity")
"""Terms that stand for what the captured tables leave out in every healthy robot: rounding at zero,
and interpolation between the nodes."""


ROUNDING = 12.0**-0.5
"""counts, standard deviation of rounding to whole ones."""
STRUCTURE = 6.0
"""Standard deviations from health that a flexible term needs at least, as in motion."""
JOINT_MARGIN = 1.1
"""Times what the most conspicuous healthy log reached. Our choice: there are few healthy logs."""


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
    """What healthy robots get for a flexible term (`models.senses.structure`)."""

    mean: float
    sd: float
    """Between robots, their own uncertainty taken off."""
    swarm_sd: float
    farthest: float
    """Largest distance, in standard deviations, of a healthy robot."""
    swarm_farthest: float


UNKNOWN = Structure(mean=0.0, sd=0.0, swarm_sd=0.0, farthest=0.0, swarm_farthest=0.0)
"""Where there is no reference at all, whatever follows something is beyond the model."""


class Health(Spread):
    """What healthy robots get for a term, and what it gains in them."""

    gain: float
    """Largest held-out deviance that the term took off a healthy robot."""
    swarm_gain: float


class Level(Finite):
    """A number of healthy robots, and its standard deviations between robots and swarms."""

    mean: float = 0.0
    sd: float = 0.0
    swarm_sd: float = 0.0
    farthest: float = 0.0
    """Largest distance of a healthy robot, in standard deviations."""
    swarm_farthest: float = 0.0


class SenseReference(Finite):
    """What is believed of healthy robots' senses."""

    schema_version: int = SCHEMA
    model: str
    robots: int
    swarms: int
    inherent: dict[str, float] = Field(default_factory=dict)
    """Coordinates of `INHERENT`."""
    terms: dict[str, Health] = Field(default_factory=dict)
    noise: Level | None = None
    """Logarithm of the infrared errors' scale over the tables' noise; None: not measured."""
    targets: Level | None = None
    """Logarithm of what infrared reads of other robots over what it would of a wall there."""
    clock: Level | None = None
    """s by which healthy robots' poses are late against their readings."""
    structure: dict[str, Structure] = Field(default_factory=dict)
    """What healthy robots get for every flexible term (`models.senses.structure`)."""
    joint: float = 1.0
    """Times its own gate that the most conspicuous of all flexible terms of a healthy log reached,
    each log judged by the others: what the size of the family costs."""
    silent: float = 1.0
    """Largest share of zeros among all readings of a healthy infrared sensor."""
    gain: float = 12.0
    """Held-out deviance that a term must take off."""
    distance: float = 4.3
    """Standard deviations from health that a term must be."""
    margin: float = 1.3
    """Times the farthest healthy robot."""
    command: str = ""

    @model_validator(mode="after")
    def _sized(self) -> SenseReference:
        """Refuse coordinates of other terms than ours."""
        for name in self.inherent:
            if name not in INHERENT:
                raise Refused("inherent", quoted(name), nearest(name, INHERENT))
        check_sizes(self.terms, seldom=True)
        return self

    def base(self, believed: Belief) -> Belief:
        """A healthy robot's senses where the model believes these."""
        return with_inherent(believed, self.inherent)

    def spread(self, key: str, size: int, *, swarm: bool) -> tuple[FloatArray, FloatArray]:
        """(p,) healthy mean and standard deviation of a term's coordinates, as in motion."""
        if not self.knows(key, swarm=swarm):
            return np.zeros(size), np.full(size, np.inf)
        if key not in self.terms:
            return np.zeros(size), np.zeros(size)
        return self.terms[key].coordinates(swarm=swarm)

    def knows(self, key: str, *, swarm: bool) -> bool:
        """Whether a term was measured in healthy robots or swarms, or health is not asked for."""
        if not self.robots:
            return True
        found = self.terms.get(key)
        return found is not None and bool(found.swarm_mean if swarm else found.mean)

    def gates(self, key: str, *, swarm: bool) -> tuple[float, float]:
        """Gain and distance that a term needs.

        What the captured tables get wrong gains something in every long healthy log: it is the
        distance that tells a fault from it. It is infinite where health is not known.
        """
        if not self.knows(key, swarm=swarm):
            return self.gain, math.inf
        least = self.distance + (SWARM_MORE if swarm else 0.0)
        if key not in self.terms:
            return self.gain, least
        found = self.terms[key]
        far = found.swarm_farthest if swarm else found.farthest
        return self.gain, max(least, self.margin * far)

    def health(self, key: str) -> Structure | None:
        """What healthy robots get for a flexible term; None: it was not measured."""
        return self.structure.get(key) if self.robots else UNKNOWN

    def structure_gate(self, key: str, *, swarm: bool) -> float:
        """Standard deviations from health at which a flexible term counts."""
        health = self.structure.get(key, UNKNOWN)
        return gate_of(health, swarm=swarm) * max(1.0, JOINT_MARGIN * self.joint)


def gate_of(health: Structure, *, swarm: bool) -> float:
    """Of one flexible term, before the size of the family is accounted for."""
    return max(STRUCTURE, health.swarm_farthest if swarm else health.farthest)


def away(value: FloatArray, error: FloatArray, mean: FloatArray, sd: FloatArray) -> float:
    """Standard deviations from health, over the coordinates that the readings tell."""
    known = error > 0.0
    wide = np.hypot(error[known], sd[known])
    return float(np.sqrt((((value - mean)[known] / wide) ** 2).sum()))


def with_inherent(belief: Belief, coordinates: Mapping[str, float]) -> Belief:
    """A belief with the inherent terms."""
    for name, coordinate in coordinates.items():
        belief = sense_causes()[name].believed(belief, np.array([coordinate]))
    return belief


def no_sense_reference(model: str) -> SenseReference:
    """What is believed where there is no reference: that the tables are right, and how counts are.

    Readings are whole counts and never below zero, so that an offset by a part of a count is no
    fault.
    """
    none, whole = (0.0,), (ROUNDING,)
    rounded = Health(
        mean=none,
        sd=whole,
        swarm_mean=none,
        swarm_sd=whole,
        farthest=0.0,
        swarm_farthest=0.0,
        gain=0.0,
        swarm_gain=0.0,
    )
    return SenseReference(
        model=model,
        robots=0,
        swarms=0,
        terms={"ir_offset": rounded},
        noise=Level(),
        targets=Level(),
        clock=Level(),
    )


def write_sense_reference(reference: SenseReference, path: Path) -> None:
    """Write as JSON, numbers at full precision."""
    write_json(reference, path)


def read_sense_reference(path: Path) -> SenseReference:
    """Read a reference file.

    Raises:
        InputError: there is no such file, or it is not a reference of senses.
    """
    what = "a reference of the senses of `realitygap reference`"
    return read_json(SenseReference, path, what, field="reference of the senses")


def beside(motion: Path) -> Path:
    """Where the reference of the senses lies that belongs to one of motion."""
    return motion.with_suffix(".senses.json")


def shipped_sense_reference(model: str, *, manoeuvres: bool = False) -> SenseReference | None:
    """The reference that comes with the package for a model of this name; None: there is none.

    With `manoeuvres` that of robots which stop and reverse, where there is one.
    """
    return find_shipped(DIRECTORY, read_sense_reference, model, manoeuvres=manoeuvres)

"""`[extension]` of a model file: named causes with their values, for which robots, from which log.

```toml
[extension]
log = "sha256 of the measured log"
command = "realitygap diagnose ..."
names = { alice = 3 }     # only where the log calls robots by name

[[extension.causes]]
name = "motor_saturation"
robots = [3]              # or "all"
word = "left"             # which wheel, where the cause has variants

[extension.causes.parameters]
limit = { value = 4.5, low = 4.4, high = 4.6, unit = "rad/s" }
```

A share, as of torque, stands beside what it is a share of:

```toml
torque = { value = 0.5, unit = "1" }
healthy_acceleration = { value = 170.0, unit = "rad/s^2" }
```
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import Annotated

import numpy as np
from pydantic import Field, field_validator, model_validator

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.cause import ALL, Cause, Parameter
from realitygap.models.belief.law_tables import DoneCurve, Whose, WrittenLaw
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.log.files import Refused, Table
from realitygap.models.log.named import Names


class ParameterValue(Table):
    """A value with its 95 % interval."""

    value: float
    low: Annotated[float, Field(allow_inf_nan=False)] | None = None
    high: Annotated[float, Field(allow_inf_nan=False)] | None = None
    unit: str = ""
    """As the catalogue has it; may be left out."""

    def check(self, parameter: Parameter) -> None:
        """Refuse a value that the catalogue's parameter cannot have."""
        name, value = parameter.name, self.value
        within = parameter.low <= value <= parameter.high  # false for NaN
        if not within and value != parameter.null:
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            expected = f"a number from {parameter.low:g} to {parameter.high:g}{unit}"
            if math.isinf(parameter.null):
                expected += f", or {parameter.null:g}, which changes nothing"
            raise Refused(name, f"{value:g}", expected)
        if self.unit not in ("", parameter.unit):
            raise Refused(f"{name}.unit", repr(self.unit), f"{parameter.unit!r}, or no unit")
        if self.low is not None and self.high is not None and self.low > self.high:
            raise Refused(f"{name}.low", f"{self.low:g}", f"at most high, {self.high:g}")


class NamedCause(Table):
    """One cause of the catalogue with values."""

    name: str
    robots: Whose = "all"
    word: str = ALL
    """Which wheel, where the cause has variants."""
    parameters: dict[str, ParameterValue]

    @property
    def cause(self) -> Cause:
        """The catalogue's entry."""
        return every_cause()[self.name]

    @model_validator(mode="after")
    def _known(self) -> NamedCause:
        """Refuse names, words, parameters and values that the catalogue does not have."""
        if self.name not in every_cause():
            raise Refused("name", repr(self.name), nearest(self.name, every_cause()))
        cause = self.cause
        if self.word not in cause.variants:
            words = nearest(self.word, cause.variants) if cause.word else "no word"
            raise Refused("word", repr(self.word), f"{words}, for {self.name}")
        if isinstance(cause, SenseCause) and cause.place and self.robots != "all":
            expected = f'"all": {self.name} belongs to the place'
            raise Refused("robots", list(self.robots), expected)
        names = [p.name for p in (*cause.parameters, *cause.given)]
        for name in self.parameters:
            if name not in names:
                valid = nearest(name, names) if names else f"no parameters for {self.name}"
                raise Refused("parameters", repr(name), valid)
        for p in cause.parameters:
            self._check(p)
        if any(self.parameters[p.name].value != p.null for p in cause.parameters):
            for p in cause.given:  # a share is of something
                self._check(p)
        return self

    def _check(self, parameter: Parameter) -> None:
        """Refuse a parameter that is absent or that the catalogue does not have so."""
        name = parameter.name
        if name not in self.parameters:
            raise Refused(f"parameters.{name}", "nothing", f"a value ({parameter.unit})")
        try:
            self.parameters[name].check(parameter)
        except Refused as error:
            field = f"parameters.{error.field}"
            raise Refused(field, error.got, error.expected) from None

    def concerns(self, robot: int | None) -> bool:
        """Whether a robot has it; None asks for what the whole swarm has."""
        return self.robots == "all" or (robot is not None and robot in self.robots)

    def applied(self, motion: Motion) -> Motion:
        """The motion with this cause."""
        return self.cause.change(motion, self._values(), self.word)

    def sensed(self, belief: Belief) -> Belief:
        """What is believed of the senses, with this cause."""
        cause = self.cause
        if not isinstance(cause, SenseCause):
            return belief
        return cause.sense(belief, self._values(), self.word)

    def _values(self) -> FloatArray:
        given = [p for p in self.cause.given if p.name in self.parameters]
        asked = (*self.cause.parameters, *given)
        return np.array([self.parameters[p.name].value for p in asked])


class Extension(Table):
    """Named causes, curves and laws, added to a minimal model."""

    log: str = ""
    """SHA-256 of the measured log they were found in."""
    command: str = ""
    causes: tuple[NamedCause, ...] = ()
    done_curve: tuple[DoneCurve, ...] = ()
    laws: tuple[WrittenLaw, ...] = ()
    calibration: tuple[NamedCause, ...] = ()
    """Terms with values that predict best beside the others: fitted, and no diagnosis."""
    names: dict[Annotated[str, Field(min_length=1)], Annotated[int, Field(ge=0)]] = Field(
        default_factory=dict
    )
    """Numbers of robots that their log calls by name: a later log of them gets the same."""

    @field_validator("names")
    @classmethod
    def _apart(cls, names: dict[str, int]) -> dict[str, int]:
        """Refuse two names of one robot."""
        if len(set(names.values())) < len(names):
            raise Refused("", repr(names), "a number of its own for each name")
        return names

    @property
    def called(self) -> Names:
        """Robots by number."""
        return Names({number: name for name, number in self.names.items()})

    @property
    def robots(self) -> list[int]:
        """Robots that some cause concerns and others not, in order; empty: all are alike."""
        told = [own for law in self.laws for own in law.amplitudes if own.robot is not None]
        causes = [one.robots for one in (*self.causes, *self.calibration) if one.robots != "all"]
        causes += [one.robots for one in self.done_curve if one.robots != "all"]
        return sorted({r for robots in causes for r in robots} | {one.robot or 0 for one in told})

    def check_robots(self, known: Collection[int], file: str) -> None:
        """Refuse robots that do not exist.

        Args:
            known: Robots that do.
            file: What to call the file.

        Raises:
            InputError: the first cause and robot.
        """
        for kind, index, robots in self._concerned():
            for robot in robots:
                if robot not in known:
                    field = f"{file}: extension.{kind}.{index}.robots"
                    called = self.called
                    listed = [called[k] for k in sorted(known)]
                    raise InputError(
                        field, called[robot], f"a robot: {nearest(called[robot], listed)}"
                    )

    def _concerned(self) -> Iterator[tuple[str, int, tuple[int, ...]]]:
        """Of each cause, curve and law of some robots, which."""
        for index, cause in enumerate(self.causes):
            yield "causes", index, () if cause.robots == "all" else cause.robots
        for index, curve in enumerate(self.done_curve):
            yield "done_curve", index, () if curve.robots == "all" else curve.robots
        for index, term in enumerate(self.calibration):
            yield "calibration", index, () if term.robots == "all" else term.robots
        for index, law in enumerate(self.laws):
            yield "laws", index, () if law.robots == "all" else law.robots

    def applied(self, motion: Motion, robot: int | None) -> Motion:
        """The motion of a robot with all that concerns it."""
        for cause in (*self.causes, *self.calibration):
            if cause.concerns(robot):
                motion = cause.applied(motion)
        for curve in self.done_curve:
            if curve.concerns(robot):
                motion = curve.applied(motion)
        for law in self.laws:
            motion = law.applied(motion, robot)
        return motion

    def sensed(self, robot: int | None) -> Belief:
        """What is believed of a robot's senses, with every cause that concerns it."""
        belief = Belief()
        for cause in self.causes:
            if cause.concerns(robot):
                belief = cause.sensed(belief)
        return belief

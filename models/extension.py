"""`[extension]` of a model file: named causes with their values, for which robots, from which log.

```toml
[extension]
log = "sha256 of the measured log"
command = "realitygap diagnose ..."

[[extension.causes]]
name = "motor_saturation"
robots = [3]              # or "all"
word = "left"             # which wheel, where the cause has variants

[extension.causes.parameters]
limit = { value = 4.5, low = 4.4, high = 4.6, unit = "rad/s" }
```
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from embedded_sim.errors import nearest
from embedded_sim.model import FloatArray
from models.catalogue import every_cause
from models.causes import ALL, Cause, Motion
from models.senses.cause import Belief, SenseCause


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ParameterValue(_Table):
    """A value with its 95 % interval."""

    value: Annotated[float, Field(allow_inf_nan=False)]
    low: Annotated[float, Field(allow_inf_nan=False)] | None = None
    high: Annotated[float, Field(allow_inf_nan=False)] | None = None
    unit: str = ""


class NamedCause(_Table):
    """One cause of the catalogue with values."""

    name: str
    robots: Literal["all"] | tuple[Annotated[int, Field(ge=0)], ...] = "all"
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
            raise ValueError(f"{self.name!r} is no cause: {nearest(self.name, every_cause())}")
        cause = self.cause
        if self.word not in cause.variants:
            raise ValueError(
                f"{self.name}: word {self.word!r}: {nearest(self.word, cause.variants)}"
            )
        names = [p.name for p in cause.parameters]
        for name in self.parameters:
            if name not in names:
                raise ValueError(f"{self.name}: parameter {name!r}: {nearest(name, names)}")
        for p in cause.parameters:
            if p.name not in self.parameters:
                raise ValueError(f"{self.name}: no {p.name} ({p.unit})")
            value = self.parameters[p.name].value
            if not p.low <= value <= p.high:
                raise ValueError(
                    f"{self.name}: {p.name} {value:g} is not within "
                    f"{p.low:g} to {p.high:g} {p.unit}"
                )
        return self

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
        return np.array([self.parameters[p.name].value for p in self.cause.parameters])


class Extension(_Table):
    """Named causes added to a minimal model."""

    log: str = ""
    """SHA-256 of the measured log they were found in."""
    command: str = ""
    causes: tuple[NamedCause, ...] = ()

    @property
    def robots(self) -> list[int]:
        """Robots that some cause concerns and others not, in order; empty: all are alike."""
        return sorted({r for cause in self.causes if cause.robots != "all" for r in cause.robots})

    def applied(self, motion: Motion, robot: int | None) -> Motion:
        """The motion of a robot with every cause that concerns it."""
        for cause in self.causes:
            if cause.concerns(robot):
                motion = cause.applied(motion)
        return motion

    def sensed(self, robot: int | None) -> Belief:
        """What is believed of a robot's senses, with every cause that concerns it."""
        belief = Belief()
        for cause in self.causes:
            if cause.concerns(robot):
                belief = cause.sensed(belief)
        return belief


__all__ = ["Extension", "NamedCause", "ParameterValue", "ValidationError"]

"""`[[extension.laws]]` of a model file: terms that a diagnosis found, with an amplitude per robot.

```toml
[[extension.laws]]
channel = "both"
robots = [1, 2]           # or "all"
unit = "1"
amplitudes = [
    { robot = 1, value = -0.080, low = -0.082, high = -0.079 },
    { robot = 2, value = -0.080, low = -0.082, high = -0.078 },
]

[[extension.laws.atoms]]
of = "place"
form = "half"
parameters = [1.57, 0.0]
```

Of `robots = "all"` an amplitude without a robot is that of every robot that has none of its own.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.embedded_sim.laws import (
    CHANNELS,
    FORMS,
    QUANTITIES,
    SIMULATED,
    Atom,
    Law,
    law_struct,
)
from realitygap.models.belief.law_words import UNIT
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.whose import whose
from realitygap.models.log.files import Refused, Table

Number = Annotated[float, Field(ge=-1e12, le=1e12, allow_inf_nan=False)]


class LawAtom(Table):
    """A factor of a law."""

    of: str
    form: str
    parameters: tuple[Number, ...] = ()

    @model_validator(mode="after")
    def _known(self) -> LawAtom:
        """Refuse what the simulator does not know."""
        if self.of not in SIMULATED:
            expected = nearest(self.of, sorted(SIMULATED))
            raise Refused("of", repr(self.of), expected)
        if self.form not in FORMS:
            raise Refused("form", repr(self.form), nearest(self.form, FORMS))
        return self

    @property
    def atom(self) -> Atom:
        """As the simulator has it."""
        of = next(one for one in QUANTITIES if one == self.of)
        form = next(one for one in FORMS if one == self.form)
        return Atom(of, form, self.parameters)


class LawAmplitude(Table):
    """Of one robot, or of every other, with its 95 % interval."""

    robot: Annotated[int, Field(ge=0)] | None = None
    value: Number
    low: Number | None = None
    high: Number | None = None


class WrittenLaw(Table):
    """One law with its amplitudes."""

    channel: str
    robots: Literal["all"] | tuple[Annotated[int, Field(ge=0)], ...]
    unit: str
    atoms: Annotated[tuple[LawAtom, ...], Field(min_length=1, max_length=2)]
    amplitudes: tuple[LawAmplitude, ...]

    @field_validator("robots", mode="before")
    @classmethod
    def _numbers(cls, robots: Any) -> Any:
        """Refuse what names no robots."""
        return whose(robots)

    @model_validator(mode="after")
    def _whole(self) -> WrittenLaw:
        """Refuse what is no law: unknown channels, units, robots without an amplitude."""
        if self.channel not in CHANNELS:
            raise Refused("channel", repr(self.channel), nearest(self.channel, CHANNELS))
        unit = UNIT.get(self.law(0.0).channel, "1")
        if self.unit != unit:
            raise Refused("unit", repr(self.unit), repr(unit))
        told = [one.robot for one in self.amplitudes]
        if len(set(told)) < len(told):
            raise Refused("amplitudes", repr(told), "each robot once")
        asked = {None} if self.robots == "all" else set(self.robots)
        extra = set(told) - asked if self.robots != "all" else set()
        if not asked or asked - set(told) or extra:
            expected = "one without a robot" if self.robots == "all" else "one for each of robots"
            raise Refused("amplitudes", repr(told), expected)
        try:
            law_struct(self.law(1.0))
        except InputError as error:
            raise Refused("atoms", error.got, error.expected) from None
        return self

    def law(self, amplitude: float) -> Law:
        """With an amplitude."""
        channel = next(one for one in CHANNELS if one == self.channel)
        return Law(channel, amplitude, tuple(one.atom for one in self.atoms))

    def of_robot(self, robot: int | None) -> float:
        """A robot's amplitude, 0 where it has none; None asks for what the whole swarm has."""
        own = {one.robot: one.value for one in self.amplitudes}
        return own.get(robot, own.get(None, 0.0))

    def applied(self, motion: Motion, robot: int | None) -> Motion:
        """The motion of a robot with this law; an amplitude of 0 leaves it as it is."""
        amplitude = self.of_robot(robot)
        if amplitude == 0.0:
            return motion
        return motion.driving(laws=(*motion.drive.laws, self.law(amplitude)))

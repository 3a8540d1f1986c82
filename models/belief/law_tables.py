"""Tables of a model file's extension: laws that a diagnosis found, and what wheels do when told.

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

[[extension.done_curve]]
robots = [3]                 # or "all"
wheel = "left"               # or "right", or "both"
told = [-6.0, -1.0, 1.0, 6.0]
done = [-5.6, 0.0, 0.0, 5.6]
```

A law has an amplitude per robot. Of `robots = "all"` an amplitude without a robot is that of every
robot that has none of its own.

A `done_curve` has straight lines between its knots (rad/s), and beyond the outer ones their values.
A dead zone, a limit, a gain and wheels that differ forwards and backwards are shapes of it.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

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
from realitygap.models.belief.cause import sides
from realitygap.models.belief.law_words import UNIT
from realitygap.models.belief.motion import Motion
from realitygap.models.log.files import Refused, Table

ROBOTS = 'robot numbers from 0, as in [3] or [1, 4], or "all"'


def whose(robots: Any) -> Any:
    """Robots as given, but for what names none, which is refused."""
    if robots == "all":
        return robots
    if isinstance(robots, str) or not isinstance(robots, Collection) or not robots:
        given = list(robots) if isinstance(robots, tuple) else robots
        raise Refused("", repr(given), ROBOTS)
    for robot in robots:
        if isinstance(robot, bool) or not isinstance(robot, int) or robot < 0:
            raise Refused("", repr(robot), ROBOTS)
    if len(set(robots)) < len(robots):
        raise Refused("", repr(list(robots)), "each robot once")
    return robots


Whose = Annotated[Literal["all"] | tuple[Annotated[int, Field(ge=0)], ...], BeforeValidator(whose)]
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
    robots: Whose
    unit: str
    atoms: Annotated[tuple[LawAtom, ...], Field(min_length=1, max_length=2)]
    amplitudes: tuple[LawAmplitude, ...]

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


Speeds = tuple[Annotated[float, Field(allow_inf_nan=False)], ...]
"""rad/s."""


class DoneCurve(Table):
    """One curve."""

    robots: Whose = "all"
    wheel: Literal["left", "right", "both"] = "both"
    told: Speeds
    """Rising."""
    done: Speeds
    """As many; never falling."""

    @model_validator(mode="after")
    def _possible(self) -> DoneCurve:
        """Refuse what C would refuse."""
        if len(self.done) != len(self.told):
            raise Refused("done", f"{len(self.done)} speeds", f"{len(self.told)}, as many as told")
        try:
            self.applied(Motion()).drive.struct()
        except InputError as error:
            raise Refused(
                error.field.removeprefix("drive.done_curve "), error.got, error.expected
            ) from None
        return self

    def concerns(self, robot: int | None) -> bool:
        """Whether a robot has it; None asks for what the whole swarm has."""
        return self.robots == "all" or (robot is not None and robot in self.robots)

    def applied(self, motion: Motion) -> Motion:
        """The motion with this curve."""
        own = tuple(zip(self.told, self.done, strict=True))
        left, right = (
            own if chosen else before
            for chosen, before in zip(sides(self.wheel), motion.drive.done_curve, strict=True)
        )
        return motion.driving(done_curve=(left, right))

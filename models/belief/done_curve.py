"""`[[extension.done_curve]]` of a model file: what wheels do of what they are told.

```toml
[[extension.done_curve]]
robots = [3]                 # or "all"
wheel = "left"               # or "right", or "both"
told = [-6.0, -1.0, 1.0, 6.0]
done = [-5.6, 0.0, 0.0, 5.6]
```

Straight lines between the knots (rad/s), and beyond the outer ones their values. A dead zone, a
limit, a gain and wheels that differ forwards and backwards are shapes of it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.cause import sides
from realitygap.models.belief.motion import Motion
from realitygap.models.belief.whose import whose
from realitygap.models.log.files import Refused, Table

Speeds = tuple[Annotated[float, Field(allow_inf_nan=False)], ...]
"""rad/s."""


class DoneCurve(Table):
    """One curve."""

    robots: Literal["all"] | tuple[Annotated[int, Field(ge=0)], ...] = "all"
    wheel: Literal["left", "right", "both"] = "both"
    told: Speeds
    """Rising."""
    done: Speeds
    """As many; never falling."""

    @field_validator("robots", mode="before")
    @classmethod
    def _numbers(cls, robots: Any) -> Any:
        """Refuse what names no robots."""
        return whose(robots)

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

"""`next_experiment` of a diagnosis, as it is read back: whatever somebody has made of the file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, field_validator

from realitygap.embedded_sim.errors import nearest
from realitygap.embedded_sim.probes import MENU
from realitygap.models.log.files import Finite, Refused

Length = Annotated[float, Field(ge=-1e6, le=1e6)]
"""m; no lab's frame is larger than 1000 km."""
Names = Annotated[tuple[int | str, ...], Field(min_length=1, max_length=100)]
"""Robots; more are in no log whose cause is named."""


class RoomTable(Finite):
    """`ground`: the circle that a manoeuvre stays in."""

    x: Length
    y: Length
    radius: Annotated[float, Field(gt=0.0, le=1e6)]
    walled: bool


class RivalTable(Finite):
    """One of `rivals`."""

    name: str
    word: str | None
    values: Mapping[str, float]


class ExpectedTable(Finite):
    """One of `expected`."""

    robot: int | str | None
    t_start: float
    t_end: float
    channel: str
    unit: str
    values: Mapping[str, float]
    apart: float


class PlanTable(Finite):
    """`plan`."""

    step: Annotated[float, Field(ge=1e-3, le=10.0)]
    """s: 1000 rows a second are more than any tracker's, a manoeuvre has parts shorter than 10."""
    ground: RoomTable
    rivals: tuple[RivalTable, ...]
    expected: tuple[ExpectedTable, ...]


class FollowingTable(Finite):
    """`next_experiment`."""

    name: str
    separates: tuple[str, ...]
    does: str
    separation: float
    lamp: str
    needs: tuple[str, ...]
    menu: tuple[Mapping[str, Any], ...]
    commands: tuple[str, ...]
    plan: PlanTable

    @field_validator("name")
    @classmethod
    def _known(cls, name: str) -> str:
        """Refuse what is not on the menu."""
        if name not in MENU:
            raise Refused("", repr(name), nearest(name, MENU))
        return name


class ProposingTable(Finite):
    """What is read of a diagnosis that proposes a manoeuvre."""

    robots: Names
    next_experiment: FollowingTable

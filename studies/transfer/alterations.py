"""Realities that differ from what robots believe, chosen because they change what pays."""

from __future__ import annotations

import math

from pydantic import BaseModel, ConfigDict

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.reality import constants as k
from realitygap.reality.effects import parse_effects
from realitygap.studies.run.experiment import Case


class Alteration(BaseModel):
    """Effects hidden in every run of a case."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    label: str
    case: Case
    effects: tuple[str, ...]
    control: bool = False
    """Expected to change little of which controller is best."""


LAMP = k.NEST[0] + 0.1
"""m from the arena's centre: on the wall, where both lamps stand."""


def _moved(degrees: float) -> tuple[str, ...]:
    """The lamp at the nest, moved along the rim counter-clockwise."""
    angle = math.radians(degrees)
    x, y = LAMP * (math.cos(angle) - 1.0), LAMP * math.sin(angle)
    return (f"lamp_moved:x={x:.4f},y={y:.4f}",)


def _dead(*sensors: int) -> tuple[str, ...]:
    return tuple(f"ls_dead_sensor:sensor={sensor}" for sensor in sensors)


_AT_NEST: Case = "light-at-nest"
_OPPOSITE: Case = "light-opposite-nest"

SHIPPED = {
    one.name: one
    for one in (
        Alteration(
            name="window-at-nest",
            label="second lamp at the nest, twice as bright",
            case=_OPPOSITE,
            effects=(f"second_lamp:x={LAMP:g},y=0,intensity=2",),
        ),
        Alteration(
            name="window-opposite",
            label="second lamp opposite, three times as bright",
            case=_AT_NEST,
            effects=(f"second_lamp:x={-LAMP:g},y=0,intensity=3",),
        ),
        *(
            Alteration(
                name=f"lamp-moved-{degrees}",
                label=f"lamp moved by {degrees}° along the rim",
                case=_AT_NEST,
                effects=_moved(degrees),
            )
            for degrees in (45, 90, 135)
        ),
        Alteration(
            name="half-blind",
            label="the left half of the light sensors dead",
            case=_OPPOSITE,
            effects=_dead(4, 5, 6, 7),
        ),
        Alteration(
            name="slow-left-wheel",
            label="left motor at most 0.6 of cruising speed",
            case=_OPPOSITE,
            effects=("motor_saturation:limit=3.6,wheel=left",),
        ),
        Alteration(
            name="latency",
            label="commands 200 ms late",
            case=_AT_NEST,
            effects=("command_latency:seconds=0.2",),
            control=True,
        ),
        Alteration(
            name="small-wheels",
            label="wheels of 0.8 of the radius",
            case=_AT_NEST,
            effects=("wheel_radius_scale:scale=0.8",),
            control=True,
        ),
    )
}


def chosen(given: tuple[str, ...], case: Case, robots: int) -> tuple[Alteration, ...]:
    """The alterations that the command line asks for: shipped names, and SPECs under a case.

    All SPECs together are one alteration; nothing given is all that ship.

    Raises:
        InputError: no such name, or a SPEC that cannot be used.
    """
    names = [one for one in given if ":" not in one]
    specs = tuple(one for one in given if ":" in one)
    for name in names:
        if name not in SHIPPED:
            raise InputError("--effect", repr(name), nearest(name, SHIPPED))
    parse_effects(specs, robots)
    own = (Alteration(name="given", label=" ".join(specs), case=case, effects=specs),)
    found = tuple(SHIPPED[name] for name in dict.fromkeys(names)) + (own if specs else ())
    return found or tuple(SHIPPED.values())

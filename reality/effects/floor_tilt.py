"""A floor that is not level."""

from __future__ import annotations

import math
from collections.abc import Mapping

from realitygap.reality import constants as k
from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    slope, direction = number(values, "slope"), number(values, "direction")
    along = k.GRAVITY * math.sin(slope)
    hardware.gravity = (
        along * math.cos(direction),
        along * math.sin(direction),
        -k.GRAVITY * math.cos(slope),
    )


EFFECT = Effect(
    name="floor_tilt",
    kind="motion",
    physics="gravity is turned against the floor: downhill is the direction given",
    parameters={
        "slope": Key(unit="rad", low=0.0, high=0.35, null=0.0),
        "direction": Key(unit="rad", low=-math.pi, high=math.pi, default=0.0),
    },
    apply=_apply,
    per_robot=False,
)

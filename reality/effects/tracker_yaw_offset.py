"""Tracker markers mounted at an angle."""

from __future__ import annotations

import math
from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.markers[robots, 2] = number(values, "angle")


EFFECT = Effect(
    name="tracker_yaw_offset",
    kind="motion",
    physics="the tracker's markers are turned against the body, counter-clockwise",
    parameters={"angle": Key(unit="rad", low=-math.pi, high=math.pi, null=0.0)},
    apply=_apply,
)

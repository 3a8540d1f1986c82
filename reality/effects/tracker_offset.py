"""Tracker markers mounted off the middle of the axle."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.markers[robots, 0] = number(values, "x")
    hardware.markers[robots, 1] = number(values, "y")


EFFECT = Effect(
    name="tracker_offset",
    kind="motion",
    physics="the tracker's markers sit ahead (x) or to the left (y) of the axle's middle",
    parameters={
        "x": Key(unit="m", low=-0.1, high=0.1, null=0.0, default=0.0),
        "y": Key(unit="m", low=-0.1, high=0.1, null=0.0, default=0.0),
    },
    apply=_apply,
)

"""Infrared in the room that every sensor adds to its reading."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.ir_offset[robots] = number(values, "counts")


EFFECT = Effect(
    name="ir_offset",
    kind="infrared",
    physics="ambient infrared adds to every reading",
    parameters={"counts": Key(unit="counts", low=-4095.0, high=4095.0, null=0.0)},
    apply=_apply,
)

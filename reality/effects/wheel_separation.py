"""Wheels nearer together or wider apart than the data sheet says."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Robots, Value, number, scale
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.axle[robots] *= number(values, "scale")


EFFECT = Effect(
    name="wheel_separation",
    kind="motion",
    physics="the wheels' joints sit nearer together or wider apart",
    parameters={"scale": scale(0.5, 1.5)},
    apply=_apply,
)

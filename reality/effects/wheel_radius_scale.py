"""Both wheels larger or smaller than the data sheet says."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Robots, Value, number, scale
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.wheel_radius[robots] *= number(values, "scale")


EFFECT = Effect(
    name="wheel_radius_scale",
    kind="motion",
    physics="both of the body's wheels have another radius",
    parameters={"scale": scale(0.5, 1.5)},
    apply=_apply,
)

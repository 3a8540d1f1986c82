"""A room brighter than when the tables were captured."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware, facing_counts


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    counts = facing_counts(0.5, hardware.lamp.power)
    hardware.light_ambient += number(values, "level") * counts


EFFECT = Effect(
    name="ambient_light",
    kind="light",
    physics="uniform background light on every sensor, as a share of what the lamp gives at 0.5 m",
    parameters={"level": Key(unit="share of the reading at 0.5 m", low=0.0, high=10.0, null=0.0)},
    apply=_apply,
    per_robot=False,
)

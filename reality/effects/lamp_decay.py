"""A lamp that dims."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.lamp.decay = number(values, "rate")


EFFECT = Effect(
    name="lamp_decay",
    kind="light",
    physics="the lamp's power falls linearly with time",
    parameters={"rate": Key(unit="1/s", low=0.0, high=0.1, null=0.0)},
    apply=_apply,
    per_robot=False,
)

"""Wheels that stand for a while before they start."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.start_delay[robots] = number(values, "seconds")


EFFECT = Effect(
    name="start_delay",
    kind="motion",
    physics="a motor holds its wheel for this long before it starts or turns the other way",
    parameters={"seconds": Key(unit="s", low=0.0, high=2.0, null=0.0)},
    apply=_apply,
)

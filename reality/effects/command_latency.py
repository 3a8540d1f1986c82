"""Commands that reach the motors late."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    hardware.command_delay[robots] = number(values, "seconds")


EFFECT = Effect(
    name="command_latency",
    kind="motion",
    physics="commands wait in a queue before the motors",
    parameters={"seconds": Key(unit="s", low=0.0, high=2.0, null=0.0)},
    apply=_apply,
)

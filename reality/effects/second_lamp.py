"""Another lamp, as a window in the room."""

from __future__ import annotations

from collections.abc import Mapping

from realitygap.reality.effects.effect import Effect, Key, Robots, Value, number
from realitygap.reality.hardware import Hardware, Lamp


def _apply(hardware: Hardware, robots: Robots, values: Mapping[str, Value]) -> None:
    lamp = hardware.lamp
    window = Lamp(
        x=number(values, "x"),
        y=number(values, "y"),
        power=lamp.power,
        scale=number(values, "intensity"),
    )
    hardware.windows.append(window)


EFFECT = Effect(
    name="second_lamp",
    kind="light",
    physics="a second source at this place, lit in every case, as high as the lamp",
    parameters={
        "x": Key(unit="m", low=-3.0, high=3.0),
        "y": Key(unit="m", low=-3.0, high=3.0),
        "intensity": Key(unit="share of the lamp", low=0.0, high=100.0, null=0.0),
    },
    apply=_apply,
    per_robot=False,
)

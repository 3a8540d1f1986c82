"""The grammar of `--effect`: `NAME:key=value[,key=value...]`; `robot=K` may be repeated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.reality.effects.effect import Effect, Key, Robots, Value
from realitygap.reality.hardware import Hardware


@dataclass(frozen=True)
class HiddenEffect:
    """An effect with its values, ready to be hidden in a swarm."""

    effect: Effect
    values: Mapping[str, Value]
    robots: tuple[int, ...]
    """Which robots have it; empty: all, or the place."""

    def hide(self, hardware: Hardware) -> None:
        """Change the hardware."""
        chosen: Robots = np.asarray(self.robots or range(hardware.robots), dtype=np.intp)
        self.effect.apply(hardware, chosen, self.values)

    def truth(self) -> dict[str, object]:
        """What `truth.json` says of it."""
        return {
            "name": self.effect.name,
            "robots": list(self.robots) or "all",
            "parameters": dict(self.values),
        }


def parse(spec: str, effects: Mapping[str, Effect], robots: int) -> HiddenEffect:
    """Read one SPEC; see `parse_effects`."""
    name, _, rest = spec.partition(":")
    if name not in effects:
        raise InputError("--effect", repr(name), nearest(name, effects))
    effect = effects[name]
    values: dict[str, Value] = {}
    chosen: list[int] = []
    for item in rest.split(",") if rest else []:
        key, equals, text = item.partition("=")
        if not equals:
            raise InputError(f"--effect {name}", repr(item), "key=value")
        if key == "robot":
            chosen.append(_robot(effect, text, robots))
        elif key not in effect.parameters:
            expected = nearest(key, [*effect.parameters, *(["robot"] if effect.per_robot else [])])
            raise InputError(f"--effect {name}", repr(key), expected)
        elif key in values:
            raise InputError(f"--effect {name}:{key}", "two values", "one")
        else:
            values[key] = _value(f"--effect {name}:{key}", text, effect.parameters[key])
    for key, parameter in effect.parameters.items():
        if key not in values:
            if parameter.default is None:
                raise InputError(f"--effect {name}", repr(rest), f"{key}=value ({parameter.unit})")
            values[key] = parameter.default
    return HiddenEffect(effect, values, tuple(sorted(set(chosen))))


def spec_of(truth: Mapping[str, Any]) -> str:
    """The SPEC of an entry of `truth.json`, as `Hidden.truth` writes it."""
    items = [f"{key}={value}" for key, value in truth["parameters"].items()]
    items += [f"robot={robot}" for robot in truth["robots"] if truth["robots"] != "all"]
    return f"{truth['name']}:" + ",".join(items)


def _robot(effect: Effect, text: str, robots: int) -> int:
    field = f"--effect {effect.name}:robot"
    if not effect.per_robot:
        raise InputError(field, text, "no robot: this effect belongs to the place")
    if not text.isdecimal() or len(text) > len(str(robots)) or int(text) >= robots:
        raise InputError(field, text, f"a robot from 0 to {robots - 1}")
    return int(text)


def _value(field: str, text: str, parameter: Key) -> Value:
    if parameter.words:
        if text in parameter.words:
            return text
        raise InputError(field, repr(text), nearest(text, parameter.words))
    expected = f"a number from {parameter.low:g} to {parameter.high:g} ({parameter.unit})"
    try:
        value = float(text)
    except ValueError:
        raise InputError(field, repr(text), expected) from None
    if not parameter.low <= value <= parameter.high:  # also false for NaN
        raise InputError(field, text, expected)
    return value

"""What an effect is: a name, its parameters, and a change to the hardware."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSORS
from realitygap.reality.hardware import Hardware

Value = float | str
Values = Mapping[str, Value]
Robots = npt.NDArray[np.intp]
Kind = Literal["motion", "infrared", "light", "task"]
Apply = Callable[[Hardware, Robots, Values], None]


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key of an effect's SPEC. A number in [low, high], or, with `words`, one of them."""

    unit: str = "1"
    low: float = -np.inf
    high: float = np.inf
    null: float | None = None
    """The number that changes nothing; None where there is none, as of a dead sensor."""
    words: tuple[str, ...] = ()
    default: Value | None = None
    """Used when the key is absent; None: the key is required."""


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A physical change of robots or place."""

    name: str
    kind: Kind
    """Where it shows first."""
    physics: str
    """What is changed, in a few words."""
    parameters: Mapping[str, Key]
    apply: Apply
    """Changes the hardware of the given robots, in place."""
    per_robot: bool = True
    """False for lamps, walls and floors: `robot=` is refused."""


def effect(
    *, kind: Kind, physics: str, per_robot: bool = True, **parameters: Key
) -> Callable[[Apply], Effect]:
    """Makes an effect, of its name, of the function below: what it does to the hardware."""

    def made(apply: Apply) -> Effect:
        return Effect(
            name=apply.__name__,
            kind=kind,
            physics=physics,
            parameters=parameters,
            apply=apply,
            per_robot=per_robot,
        )

    return made


WHEEL = Key(words=("left", "right", "both"), default="both")
"""Which wheels."""
SENSOR = Key(words=tuple(str(i) for i in range(SENSORS)))
"""Which of the ring's eight sensors."""
SENSOR_OR_ALL = Key(words=(*SENSOR.words, "all"), default="all")


def number(values: Values, key: str) -> float:
    """A parameter that is a number."""
    return float(values[key])


def scale(low: float, high: float) -> Key:
    """A factor on something nominal."""
    return Key(low=low, high=high, null=1.0)


def wheels(values: Values) -> slice:
    """Columns of a (robots, 2) array that the key `wheel` names."""
    return {"left": slice(0, 1), "right": slice(1, 2), "both": slice(0, 2)}[str(values["wheel"])]


def sensors(values: Values) -> slice:
    """Columns of a (robots, 8) array that the key `sensor` names."""
    if values["sensor"] == "all":
        return slice(0, SENSORS)
    sensor = int(values["sensor"])
    return slice(sensor, sensor + 1)

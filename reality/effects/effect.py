"""What an effect is: a name, its parameters, and a change to the hardware."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reality.hardware import Hardware

Value = float | str
Robots = npt.NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One key of an effect's SPEC. A number in [low, high], or, with `words`, one of them."""

    unit: str = "1"
    low: float = -np.inf
    high: float = np.inf
    words: tuple[str, ...] = ()
    default: Value | None = None
    """Used when the key is absent; None: the key is required."""


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A physical change of robots or place."""

    name: str
    physics: str
    """What is changed, in a few words."""
    parameters: Mapping[str, Parameter]
    apply: Callable[[Hardware, Robots, Mapping[str, Value]], None]
    """Changes the hardware of the given robots, in place."""
    per_robot: bool = True
    """False for lamps, walls and floors: `robot=` is refused."""


def number(values: Mapping[str, Value], key: str) -> float:
    """A parameter that is a number."""
    return float(values[key])

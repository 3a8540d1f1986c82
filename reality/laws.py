"""Further laws of an odd world: what is wrong with it when no effect of the catalogue is.

Each law is a function that is applied where its quantity arises; None, or an empty list, leaves the
world as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

WheelLaw = Callable[[FloatArray, FloatArray, FloatArray, float], FloatArray]
"""(speeds (robots, 2) rad/s, angles turned (robots, 2) rad, poses (robots, 3), s) -> speeds."""
TrackerLaw = Callable[[FloatArray], FloatArray]
"""Poses (robots, 3) -> poses seen."""
InfraredLaw = Callable[[FloatArray, FloatArray], FloatArray]
"""(sensors' directions in the world (robots, 8) rad, poses (robots, 3)) -> counts to add."""
LightLaw = Callable[[FloatArray], FloatArray]
"""Counts of the light sensors (robots, 8) -> counts that they tell. Asked once in each control
step, so that it may remember what it was asked before."""
LampLaw = Callable[[float], float]
"""s -> factor on the lamp's power."""


@dataclass
class Laws:
    """All of them."""

    wheels: WheelLaw | None = None
    tracker: TrackerLaw | None = None
    infrared: InfraredLaw | None = None
    lamp: LampLaw | None = None
    light: list[LightLaw] = field(default_factory=list)
    """One after the other."""

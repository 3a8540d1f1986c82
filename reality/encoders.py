"""Wheel encoders: what the wheels really turned, in whole steps."""

from __future__ import annotations

import numpy as np

from realitygap.reality import constants as k
from realitygap.reality.engine import Engine
from realitygap.reality.hardware import FloatArray


class Encoders:
    """Step counters on both wheels of every robot, read once per control step."""

    def __init__(self, robots: int) -> None:
        self.speeds: FloatArray = np.zeros((robots, 2))
        """rad/s, left and right: the mean over the control step that ends now, of whole steps."""
        self._angles: FloatArray = np.zeros((robots, 2))
        self._steps: FloatArray = np.zeros((robots, 2))

    def read(self, engine: Engine) -> None:
        """Fill `speeds` from the steps counted since the last reading."""
        engine.wheel_angles(self._angles)
        steps = np.rint(self._angles / k.WHEEL_STEP)
        np.subtract(steps, self._steps, out=self.speeds)
        self.speeds *= k.WHEEL_STEP / k.CONTROL_STEP
        self._steps = steps

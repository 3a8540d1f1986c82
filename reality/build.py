"""How robots of one make differ: each is built a little off nominal, drawn once for a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from realitygap.embedded_sim import SENSORS
from realitygap.reality import constants as k
from realitygap.reality.hardware import FloatArray, Hardware


@dataclass(frozen=True)
class Build:
    """Factors on what a robot would be made of, one row per robot, and where its marker sits."""

    spread: float
    """Relative s.d. of every factor."""
    wheel_radius: FloatArray
    """(robots, 2), left and right."""
    axle: FloatArray
    """(robots,)."""
    motor_torque: FloatArray
    """(robots,)."""
    ir_gain: FloatArray
    """(robots, 8)."""
    light_gain: FloatArray
    """(robots, 8)."""
    marker: FloatArray
    """(robots, 2) m ahead and to the left, s.d. of each the spread times the nominal axle: who
    cannot place wheels better than that does not place markers better."""

    @classmethod
    def drawn(cls, robots: int, spread: float, seed: np.random.SeedSequence) -> Build:
        """Independent normal draws about nominal, one stream per kind of part.

        Args:
            robots: How many.
            spread: Relative s.d.; small, so that no factor comes near zero. At 0 factors are 1 and
                markers sit where they sat, to the last bit.
            seed: Spawned by part.
        """
        wheels, axle, motors, infrared, light, marker = (
            np.random.default_rng(child) for child in seed.spawn(6)
        )

        def about(nominal: float, random: np.random.Generator, *shape: int) -> FloatArray:
            return nominal + spread * random.standard_normal((robots, *shape))

        return cls(
            spread=spread,
            wheel_radius=about(1.0, wheels, 2),
            axle=about(1.0, axle),
            motor_torque=about(1.0, motors),
            ir_gain=about(1.0, infrared, SENSORS),
            light_gain=about(1.0, light, SENSORS),
            marker=k.AXLE * about(0.0, marker, 2),
        )

    def apply(self, hardware: Hardware) -> None:
        """Change the hardware, in place; what is hidden in it is built no better than the rest."""
        hardware.wheel_radius *= self.wheel_radius
        hardware.axle *= self.axle
        hardware.motor_torque *= self.motor_torque
        hardware.ir_amplitude *= self.ir_gain
        hardware.light_gain *= self.light_gain
        hardware.markers[:, :2] += self.marker

    def truth(self) -> dict[str, object]:
        """What `truth.json` says of it: nothing where robots are all alike."""
        if not self.spread:
            return {}
        parts = ("wheel_radius", "axle", "motor_torque", "ir_gain", "light_gain", "marker")
        robots = [
            {"robot": robot, **{part: getattr(self, part)[robot].tolist() for part in parts}}
            for robot in range(len(self.axle))
        ]
        return {"build": {"spread": self.spread, "robots": robots}}

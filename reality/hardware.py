"""What each robot and the place are really made of: nominal values that an effect may change.

One array per property, one row per robot, so that the 40 ms loop never sees a robot as an object.

`Laws` are what is wrong with an odd world when no effect of the catalogue is: each is a function
that is applied where its quantity arises; None, or an empty list, leaves the world as it is.

Robots of one make differ: each is built a little off nominal, drawn once for a run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SENSOR_ANGLES, SENSORS
from realitygap.reality import constants as k
from realitygap.reality.arena import ForagingArena

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


NOMINAL = ForagingArena()


@dataclass
class Lamp:
    """A light source."""

    x: float = 0.0
    y: float = 0.0
    """m: of the run's lamp, how far it stands from where the case has it."""
    height: float = k.LAMP_HEIGHT
    """m."""
    power: float = k.LAMP_POWER
    """counts m^exponent, as the run was asked for."""
    scale: float = 1.0
    """On the power."""
    exponent: float = k.LIGHT_EXPONENT
    decay: float = 0.0
    """1/s: share of the power lost, linearly."""


def lamp_power(range_m: float) -> float:
    """Counts m^2 at which a facing sensor of a robot `range_m` from the lamp reads 40 counts.

    40 counts is the contrast that the light behaviours ask for; `LAMP_POWER` is this at 0.8 m.
    """
    ahead = max(range_m - k.BODY_RADIUS, k.BODY_RADIUS)
    squared = ahead**2 + (k.LAMP_HEIGHT - k.SENSOR_HEIGHT) ** 2
    return 40.0 * float(squared**1.5) / ahead


def facing_counts(range_m: float, power: float) -> float:
    """Counts that a facing sensor of a robot `range_m` from a lamp of so many counts m^2 reads."""
    return 40.0 * power / lamp_power(range_m)


@dataclass
class Hardware:
    """Everything physical about a swarm and its arena."""

    wheel_radius: FloatArray
    """(robots, 2) m."""
    axle: FloatArray
    """(robots,) m."""
    wheel_friction: FloatArray
    """(robots,)."""
    motor_torque: FloatArray
    """(robots,) N m per wheel."""
    command_delay: FloatArray
    """(robots,) s from a command to the motors."""
    motor_lag: FloatArray
    """(robots,) s, time constant of a first-order answer."""
    speed_limit: FloatArray
    """(robots, 2) rad/s, most a motor turns."""
    dead_zone: FloatArray
    """(robots, 2) rad/s, slower commands do not turn the wheel."""
    motor_gain: FloatArray
    """(robots, 2) speed that a motor is asked for, over what its wheel is told."""
    droop: FloatArray
    """(robots,) 1/s, share of speed lost with time."""
    start_delay: FloatArray
    """(robots,) s that a motor holds its wheel before it starts or turns the other way."""
    slew_limit: FloatArray
    """(robots,) rad/s^2, most by which the speed that a motor is asked for changes."""
    turn_first: FloatArray
    """(robots,) rad/s; where a wheel would be faster, speed gives way and the turn rate is kept."""
    markers: FloatArray
    """(robots, 3) m, m, rad: where the tracker's markers sit in the robot's frame."""
    clock_delay: FloatArray
    """(robots,) s by which the tracker's poses are late."""
    gravity: tuple[float, float, float]
    """m/s^2 in the floor's frame."""
    sensor_angles: FloatArray
    """(robots, 8) rad from forward."""
    ir_amplitude: FloatArray
    """(robots, 8) counts m^2, A of A / (d + 9 mm)^2."""
    ir_outliers: FloatArray
    """(robots, 8) share of gross outliers."""
    ir_alive: FloatArray
    """(robots, 8) 1, or 0 where the sensor reads nothing."""
    ir_offset: FloatArray
    """(robots, 8) counts, whatever the sensor sees."""
    ir_noise: FloatArray
    """(robots, 8), on the s.d. of the infrared's noise."""
    light_gain: FloatArray
    """(robots, 8)."""
    light_ambient: FloatArray
    """(robots, 8) counts."""
    light_response: FloatArray
    """(robots, 8) exponent of the answer to light, as a share of full scale."""
    nest: FloatArray
    """(robots, 3) m: x, y, radius of where the virtual sensor says nest."""
    lamp: Lamp
    windows: list[Lamp]
    """More lamps, lit in every case."""
    laws: Laws
    arena: ForagingArena
    wall_reflectance: float = 1.0
    """Of the wall in the infrared, against the nominal wall."""

    @property
    def robots(self) -> int:
        """How many robots there are."""
        return len(self.axle)

    @classmethod
    def nominal(cls, robots: int, arena: ForagingArena = NOMINAL) -> Hardware:
        """Robots as the data sheets have them, all alike, in an arena."""

        def rows(values: npt.ArrayLike) -> FloatArray:
            return np.tile(np.asarray(values, dtype=np.float64), (robots, 1))

        return cls(
            wheel_radius=rows([k.WHEEL_RADIUS] * 2),
            axle=np.full(robots, k.AXLE),
            wheel_friction=np.full(robots, k.WHEEL_FRICTION),
            motor_torque=np.full(robots, k.MOTOR_TORQUE),
            command_delay=np.zeros(robots),
            motor_lag=np.zeros(robots),
            speed_limit=rows([np.inf] * 2),
            dead_zone=rows([0.0] * 2),
            motor_gain=rows([1.0] * 2),
            droop=np.zeros(robots),
            start_delay=np.zeros(robots),
            slew_limit=np.full(robots, np.inf),
            turn_first=np.full(robots, np.inf),
            markers=np.zeros((robots, 3)),
            clock_delay=np.zeros(robots),
            gravity=(0.0, 0.0, -k.GRAVITY),
            sensor_angles=rows(SENSOR_ANGLES),
            ir_amplitude=rows([counts * k.IR_OFFSET**2 for counts in k.IR_CONTACT_COUNTS]),
            ir_outliers=rows(k.IR_OUTLIERS),
            ir_alive=rows([1.0] * SENSORS),
            ir_offset=rows([0.0] * SENSORS),
            ir_noise=rows([1.0] * SENSORS),
            light_gain=rows([1.0] * SENSORS),
            light_ambient=rows([k.LIGHT_AMBIENT] * SENSORS),
            light_response=rows([1.0] * SENSORS),
            nest=rows(arena.nest),
            lamp=Lamp(),
            windows=[],
            laws=Laws(),
            arena=arena,
        )


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

"""What a simulator believes: the constant model that the C core reads.

Plain immutable data. `models` reads it from files; this room only carries it to C. Null values of
the motion terms make the minimal model of the paper (section III-E) and change no bit of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from embedded_sim._core import ffi

SENSORS = 8
"""Infrared and light sensors of an e-puck."""

SCENARIOS = ("opposite", "none", "at_nest")
"""Lamp scenarios by third of S0 (paper, Fig. 5)."""

CONTROL_STEP = 0.04
"""s; control, virtual sensor and simulation step (paper, III-D and III-E)."""

SENSOR_ANGLES = (-0.297, -0.855, -1.571, -2.618, 2.618, 1.571, 0.855, 0.297)
"""rad from forward, counter-clockwise, ps0 (front-right) clockwise to ps7 (front-left): Xpuck."""

Pair = tuple[float, float]
FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """How two wheels answer commands: pairs are (left, right); nulls make the minimal model."""

    wheel_radius: Pair = (0.0205, 0.0205)
    """m; argos3-epuck (Webots and the gctronic driver give 20 mm)."""
    axle: float = 0.053
    """m between the wheels' ground contacts; gctronic driver, argos3-epuck."""
    latency: float = 0.0
    """s from command to motor."""
    time_constant: float = 0.0
    """s, first-order answer of the motors."""
    acceleration: Pair = (math.inf, math.inf)
    """rad/s^2, most a wheel changes its speed by."""
    speed_limit: Pair = (math.inf, math.inf)
    """rad/s, most a wheel turns."""
    dead_zone: Pair = (0.0, 0.0)
    """rad/s; commands below do not turn a wheel."""
    droop_rate: float = 0.0
    """1/s, relative loss of speed with time since the log or trial began."""

    def struct(self) -> Any:
        """The C struct `rg_drive`."""
        return ffi.new("rg_drive *", {f.name: getattr(self, f.name) for f in fields(self)})


@dataclass(frozen=True, kw_only=True, eq=False)
class Tables:
    """Captured sensor readings of a nominal robot; axes as documented in `rg_tables`."""

    ps_counts: npt.NDArray[np.float32]
    """(8, distances, incidences) counts."""
    ps_range: float
    """m; the distance axis is `ps_range * u**2`, u uniform in [0, 1]."""
    ps_noise: FloatArray
    """(8,) half width of uniform noise relative to the reading."""
    ps_noise_floor: float
    """counts, half width of uniform noise."""
    ls_counts: npt.NDArray[np.float32]
    """(distances, bearings) counts below dark; bearings from -pi, uniform on the circle."""
    ls_range: float
    """m; the distance axis is `ls_range * u**2`."""
    ls_dark: float
    """counts in the dark."""
    ls_noise: float
    """counts, half width of uniform noise."""
    counts_max: float = 4095.0
    """12-bit converter."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PointModel:
    """The embedded simulator's model of robot, sensors and arena (REP-103 axes, SI units)."""

    drive: Drive = field(default_factory=Drive)
    tables: Tables | None = None
    """None for models of robots whose sensors are not modelled: motion alone can be replayed."""
    body_radius: float = 0.035
    arena_radius: float = 0.6
    nest: tuple[float, float, float] = (0.5, 0.0, 0.2)
    """x, y, radius in m."""
    food_radius: float = 0.05
    food_items: int = 7
    lamps: tuple[Pair | None, Pair | None, Pair | None] = ((-0.6, 0.0), None, (0.6, 0.0))
    """Lamp position (m) for each of `SCENARIOS`."""
    lamp_gain: float = 1.0
    sensor_angles: tuple[float, ...] = SENSOR_ANGLES
    ps_gain: tuple[float, ...] = (1.0,) * SENSORS
    ls_gain: tuple[float, ...] = (1.0,) * SENSORS

    @cached_property
    def _around(self) -> npt.NDArray[np.float32]:
        """The light table with its circle of bearings three times over, as C looks it up."""
        assert self.tables is not None
        circle = self.tables.ls_counts
        return np.ascontiguousarray(np.hstack([circle, circle, circle, circle[:, :1]]))

    @cached_property
    def struct(self) -> Any:
        """The C struct `rg_model`; lives as long as this object.

        Raises:
            ValueError: the model has no sensor tables.
        """
        if self.tables is None:
            raise ValueError("this model has no sensor tables: expected [sensors] in its file")
        t = self.tables
        shape, light = t.ps_counts.shape, t.ls_counts.shape
        lamps = [lamp or (0.0, 0.0) for lamp in self.lamps]
        struct = ffi.new("rg_model *")
        struct.drive = self.drive.struct()[0]
        struct.tables.ps_counts = ffi.from_buffer("float[]", t.ps_counts)
        struct.tables.ps_distances, struct.tables.ps_incidences = shape[1], shape[2]
        struct.tables.ls_counts = ffi.from_buffer("float[]", self._around)
        struct.tables.ls_distances, struct.tables.ls_bearings = light
        struct.tables.ps_noise = t.ps_noise.tolist()
        for name in ("ps_range", "ps_noise_floor", "ls_range", "ls_dark", "ls_noise", "counts_max"):
            setattr(struct.tables, name, getattr(t, name))
        struct.body_radius, struct.arena_radius = self.body_radius, self.arena_radius
        struct.nest_x, struct.nest_y, struct.nest_radius = self.nest
        struct.food_radius, struct.food_items = self.food_radius, self.food_items
        struct.lamp_on = [lamp is not None for lamp in self.lamps]
        struct.lamp_x, struct.lamp_y = [x for x, _ in lamps], [y for _, y in lamps]
        struct.lamp_gain = self.lamp_gain
        struct.sensor_angle = self.sensor_angles
        struct.sensor_cos = [math.cos(a) for a in self.sensor_angles]
        struct.sensor_sin = [math.sin(a) for a in self.sensor_angles]
        struct.ps_gain, struct.ls_gain = self.ps_gain, self.ls_gain
        struct.control_step = CONTROL_STEP
        return struct

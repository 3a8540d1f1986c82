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

from realitygap.embedded_sim._core import ffi, lib
from realitygap.embedded_sim.binding import check, finite, memory, refusal, structure, whole
from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.laws import MOST_LAWS, Law, law_struct
from realitygap.embedded_sim.senses import LampGeometry, Senses, worked_in
from realitygap.embedded_sim.tables import FloatArray as FloatArray
from realitygap.embedded_sim.tables import Tables

SENSORS = 8
"""Infrared and light sensors of an e-puck."""

SCENARIOS = ("opposite", "none", "at_nest")
"""Lamp scenarios by third of S0 (paper, Fig. 5)."""

CONTROL_STEP = 0.04
"""s; control, virtual sensor and simulation step (paper, III-D and III-E)."""

SENSOR_ANGLES = (-0.297, -0.855, -1.571, -2.618, 2.618, 1.571, 0.855, 0.297)
"""rad from forward, counter-clockwise, ps0 (front-right) clockwise to ps7 (front-left): Xpuck."""

Pair = tuple[float, float]
Curve = tuple[Pair, ...]
"""Knots (told, done) in rad/s, at most `MOST_KNOTS`; lines between, flat beyond."""
MOST_KNOTS = 8
"""Of a curve in C."""


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
    start_delay: float = 0.0
    """s that a wheel stands before it starts, or before it turns the other way."""
    turn_first: float = math.inf
    """rad/s; where a wheel would be faster, speed gives way and the turn rate stays."""

    done_curve: tuple[Curve, Curve] = ((), ())
    """What the left and the right wheel do of what they are told; none: as told."""
    laws: tuple[Law, ...] = ()
    """What is added to motion."""
    reach: float = 0.0
    """m from the arena's middle to where a robot's touches the wall; laws alone ask for it."""
    body: float = 0.0
    """m, radius of a robot; laws alone ask for it."""

    def struct(self) -> Any:
        """The C struct `rg_drive`; laws of amplitude 0 are left out.

        Raises:
            InputError: a field that C refuses.
        """
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        values = {name: value for name, value in values.items() if name not in _OTHERS}
        struct, why = structure("rg_drive *", "drive", values, _PAIRS), refusal()
        for side, curve in enumerate(self.done_curve):
            if len(curve) > MOST_KNOTS:
                raise InputError("drive.done_curve knots", f"{len(curve)}", f"2 to {MOST_KNOTS}")
            struct.knots[side] = len(curve)
            struct.told[side], struct.done[side] = zip(*curve, strict=True) if curve else ((), ())
        laws = [law_struct(law) for law in self.laws if law.amplitude != 0.0]
        if len(laws) > MOST_LAWS:
            raise InputError("drive.laws", f"{len(laws)}", f"at most {MOST_LAWS}")
        if laws:
            struct.laws, struct.law = len(laws), laws
        check(lib.rg_check_drive(struct, why), why)
        return struct


_OTHERS = ("laws", "done_curve")
_PAIRS = {
    field.name: 2
    for field in fields(Drive)
    if isinstance(field.default, tuple) and field.name not in _OTHERS
}


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
    """Power of the lamp set up, relative to the captured one's."""
    lamp_height: float = 0.10
    """m above the floor, of the captured lamp."""
    sensor_height: float = 0.033
    """m above the floor."""
    sensor_angles: tuple[float, ...] = SENSOR_ANGLES
    senses: Senses = field(default_factory=Senses)

    @cached_property
    def _worked_in(self) -> tuple[Tables, npt.NDArray[np.float32]]:
        """The tables as believed, and the light's as C has them: the circle three times over.

        Raises:
            InputError: the model has no sensor tables, or they cannot be used.
        """
        if self.tables is None:
            raise InputError("sensors", "no sensor tables", "[sensors] in the model's file")
        self._check_numbers()
        geometry = LampGeometry(
            lamp_height=self.lamp_height,
            sensor_height=self.sensor_height,
            body_radius=self.body_radius,
        )
        tables = worked_in(self.tables.checked, self.senses, geometry, self._farthest)
        circle = tables.ls_counts
        rows = np.hstack([circle, circle, circle, circle[:, :1]])
        return tables, np.append(rows, np.zeros(lib.RG_AHEAD, rows.dtype))

    def __getstate__(self) -> dict[str, Any]:
        """Without what C has of it: that is made anew where it is asked for."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def _check_numbers(self) -> None:
        """Refuse what C cannot be given, or what the tables cannot be worked out from."""
        self.senses.check()
        for name in _NUMBERS:
            finite(name, (getattr(self, name),), 1)
        finite("nest", self.nest, 3)
        finite("sensor_angles", self.sensor_angles, SENSORS)
        if len(self.lamps) != len(SCENARIOS):
            raise InputError("lamps", f"{len(self.lamps)} places", "one, or None, per scenario")
        for lamp in filter(None, self.lamps):
            finite("lamps", lamp, 2)

    @property
    def _farthest(self) -> float:
        """m, most from a robot in the arena to a lamp; 0: there is none."""
        shift_x, shift_y = self.senses.lamp_shift
        moved = [(x + shift_x, y + shift_y) for x, y in filter(None, self.lamps)]
        second = [self.senses.second_lamp[:2]] if self.senses.second_lamp else []
        inside = self.arena_radius - self.body_radius
        return max((math.hypot(x, y) + inside for x, y in (*moved, *second)), default=0.0)

    @cached_property
    def struct(self) -> Any:
        """The C struct `rg_model`; lives as long as this object.

        Raises:
            InputError: the model has no sensor tables, or a field that C refuses.
        """
        struct = ffi.new("rg_model *")
        struct.drive = self.drive.struct()[0]
        self._fill_tables(struct.tables)
        self._fill_places(struct)
        self._fill_light(struct)
        turned = math.remainder(self.senses.rotation, math.tau)
        angles = [math.remainder(angle + turned, math.tau) for angle in self.sensor_angles]
        struct.sensor_angle = angles
        struct.sensor_cos = [math.cos(a) for a in angles]
        struct.sensor_sin = [math.sin(a) for a in angles]
        struct.ps_gain = [gain * self.senses.wall_albedo for gain in self.senses.ps_gain]
        struct.ps_offset = self.senses.ps_offset
        struct.control_step = CONTROL_STEP
        why = refusal()
        check(lib.rg_check_model(struct, why), why)
        return struct

    def _fill_places(self, struct: Any) -> None:
        struct.body_radius, struct.arena_radius = self.body_radius, self.arena_radius
        struct.nest_x, struct.nest_y, struct.nest_radius = self.nest
        struct.food_radius = self.food_radius
        struct.food_items = whole("food_items", self.food_items)

    def _fill_tables(self, struct: Any) -> None:
        t, circle = self._worked_in
        noise = self.senses.ps_noise
        struct.ps_counts, struct.ps_floats = memory("float[]", t.ps_counts), t.ps_counts.size
        struct.ps_distances, struct.ps_incidences = t.ps_counts.shape[1:]
        struct.ps_noise = [noise * half for half in t.ps_noise.tolist()]
        struct.ps_noise_floor = noise * t.ps_noise_floor
        struct.ls_counts, struct.ls_floats = memory("float[]", circle), circle.size
        struct.ls_distances, struct.ls_bearings = t.ls_counts.shape
        # a dead sensor is covered: it does not see the room's light either
        struct.ls_dark = [t.ls_dark if gain else t.counts_max for gain in self.senses.ls_gain]
        for name in ("ps_range", "ls_range", "ls_noise", "counts_max"):
            setattr(struct, name, getattr(t, name))

    def _fill_light(self, struct: Any) -> None:
        senses = self.senses
        shift_x, shift_y = senses.lamp_shift
        lamps = [lamp or (0.0, 0.0) for lamp in self.lamps]
        struct.lamp_on = [lamp is not None for lamp in self.lamps]
        struct.lamp_x = [x + shift_x for x, _ in lamps]
        struct.lamp_y = [y + shift_y for _, y in lamps]
        worked = senses.light_gamma != 1.0  # then the intensity went through the response
        struct.lamp_gain = self.lamp_gain * (1.0 if worked else senses.lamp_intensity)
        struct.lamp_decay = senses.lamp_decay
        struct.ls_gain = senses.ls_gain
        second = senses.second_lamp or (0.0, 0.0, 0.0)
        struct.second_x, struct.second_y, struct.second_gain = second


_NUMBERS = (
    "body_radius",
    "arena_radius",
    "food_radius",
    "lamp_gain",
    "lamp_height",
    "sensor_height",
)
"""Fields of a model that are one number each."""

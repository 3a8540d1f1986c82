"""How sensors and lamp differ from those the tables were captured from.

Most differences are functions of distance and bearing alone: they are worked into the tables once,
when a model is built, so that an extended model senses at the price of the minimal one. Null values
change no bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from realitygap.embedded_sim._core import lib
from realitygap.embedded_sim.binding import finite
from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.tables import FloatArray, Tables

NONE = (0.0,) * 8
UNITY = (1.0,) * 8
OUTERMOST = 10
"""Nodes of distance that tell how bright a lamp is farther off. Our choice: counts are whole ones,
so far out some per cent of what is read, and the law holds from half of the table's range on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Senses:
    """Terms of the sensors' and the lamp's model; the defaults make the minimal model."""

    ps_gain: tuple[float, ...] = UNITY
    """(8,) on every infrared reading; 0: a dead sensor."""
    ps_offset: tuple[float, ...] = NONE
    """(8,) counts of ambient infrared."""
    ps_noise: float = 1.0
    """on the infrared's noise."""
    wall_albedo: float = 1.0
    """on every reading of the wall."""
    rotation: float = 0.0
    """rad, counter-clockwise, of the ring of infrared and light sensors; whole turns do nothing."""
    ls_gain: tuple[float, ...] = UNITY
    """(8,) on what every light sensor reads of the lamps; 0: a dead sensor, which is covered and
    does not see the room's light either."""
    lamp_intensity: float = 1.0
    lamp_height: float | None = None
    """m above the floor; None: as captured."""
    light_exponent: float = 2.0
    """of the distance in the law of light."""
    lamp_shift: tuple[float, float] = (0.0, 0.0)
    """m, of every lamp."""
    lamp_decay: float = 0.0
    """1/s, relative loss of the lamp's power with time since the log or trial began."""
    ambient_light: float = 0.0
    """uniform background as a share of what a facing sensor reads at 0.5 m from the lamp."""
    light_gamma: float = 1.0
    """exponent of the light sensors' response curve, full scale kept."""
    second_lamp: tuple[float, float, float] | None = None
    """x, y (m) and intensity relative to the first lamp's; in every scenario."""

    def check(self) -> None:
        """Refuse what is no term.

        Raises:
            InputError: a field is not finite, or has not as many numbers as it should.
        """
        for name, count in _COUNTS.items():
            value = getattr(self, name)
            if value is not None:
                finite(f"senses.{name}", value if count > 1 else (value,), count)


_SEVERAL = {"ps_gain": 8, "ps_offset": 8, "ls_gain": 8, "lamp_shift": 2, "second_lamp": 3}
_COUNTS = {field.name: _SEVERAL.get(field.name, 1) for field in fields(Senses)}
"""How many numbers each field has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LampGeometry:
    """Where the captured lamp stood (m): needed only to ask what another height would give."""

    lamp_height: float = 0.10
    sensor_height: float = 0.033
    body_radius: float = 0.035


def worked_in(
    tables: Tables, senses: Senses, geometry: LampGeometry, farthest: float = 0.0
) -> Tables:
    """The tables with every term that depends on distance and bearing alone worked in.

    Args:
        tables: As captured.
        senses: What is believed.
        geometry: Of lamp and robot as captured.
        farthest: m from a robot to a lamp; where it is past the end of the light's table, the table
            is continued.

    Raises:
        InputError: the table would have too many rows, or hold what is not finite.
    """
    if farthest > tables.ls_range:
        tables = _continued(tables, geometry, farthest)
    with np.errstate(all="ignore"):
        ratio = _law_ratio(tables, senses, geometry)
        lit: FloatArray = tables.ls_counts.astype(np.float64) * ratio
        dark = tables.ls_dark - senses.ambient_light * _facing_at_half_a_metre(tables)
        if senses.light_gamma != 1.0:
            lit, dark = _through_response(lit * senses.lamp_intensity, dark, tables, senses)
        counts = np.ascontiguousarray(lit, dtype=np.float32)
    if not (np.isfinite(counts).all() and math.isfinite(dark)):
        terms = ", ".join(f"{name} = {getattr(senses, name)}" for name in _WORKED_IN)
        raise InputError("senses", terms, "terms that keep the light's table finite")
    return replace(tables, ls_counts=counts, ls_dark=dark)


_WORKED_IN = ("light_exponent", "lamp_height", "ambient_light", "light_gamma", "lamp_intensity")


def _law_ratio(tables: Tables, senses: Senses, geometry: LampGeometry) -> FloatArray:
    """(distances, bearings): light under the changed law over light under the captured one."""
    across = _across(tables, geometry)
    captured = np.sqrt(across + (geometry.lamp_height - geometry.sensor_height) ** 2)
    height = geometry.lamp_height if senses.lamp_height is None else senses.lamp_height
    changed = np.sqrt(across + (height - geometry.sensor_height) ** 2)
    # the cosine's distance and the law's: 1 + 2 powers as captured
    ratio: FloatArray = captured**3.0 / changed ** np.float64(1.0 + senses.light_exponent)
    return ratio


def _continued(tables: Tables, geometry: LampGeometry, farthest: float) -> Tables:
    """The tables with light to a farther end, at nodes spaced as before: it falls there with the
    square of the distance from what the outermost nodes tell."""
    captured, bearings = tables.ls_counts.shape
    wanted = (captured - 1) * math.sqrt(farthest / tables.ls_range)
    if not (wanted + 2.0) * (3.0 * bearings + 1.0) + lib.RG_AHEAD < lib.RG_TABLE_MAX:
        raise InputError("lamps", f"{farthest:g} m away", "lamps that the light's table can reach")
    steps = math.ceil(wanted)
    wider = replace(
        tables,
        ls_counts=np.pad(tables.ls_counts, ((0, steps + 1 - captured), (0, 0))),
        ls_range=tables.ls_range * (steps / (captured - 1)) ** 2,
    )
    across = _across(wider, geometry) + (geometry.lamp_height - geometry.sensor_height) ** 2
    outermost = slice(max(captured - OUTERMOST, 0), captured)
    power = tables.ls_counts[outermost].sum(axis=0) / (1.0 / across[outermost]).sum(axis=0)
    wider.ls_counts[captured:] = power / across[captured:]
    return wider


def _across(tables: Tables, geometry: LampGeometry) -> FloatArray:
    """(distances, bearings) squared m on the floor from a sensor at the rim to the lamp."""
    distances, bearings = tables.ls_counts.shape
    r = tables.ls_range * np.linspace(0.0, 1.0, distances)[:, np.newaxis] ** 2
    bearing = -math.pi + 2.0 * math.pi * np.arange(bearings) / bearings
    rim = geometry.body_radius
    return np.asarray(r**2 + rim**2 - 2.0 * r * rim * np.cos(bearing))


def _facing_at_half_a_metre(tables: Tables) -> float:
    """counts below dark of a sensor that faces the lamp from 0.5 m, as captured."""
    distances, bearings = tables.ls_counts.shape
    nodes = tables.ls_range * np.linspace(0.0, 1.0, distances) ** 2
    return float(np.interp(0.5, nodes, tables.ls_counts[:, bearings // 2]))


def _through_response(
    lit: FloatArray, dark: float, tables: Tables, senses: Senses
) -> tuple[FloatArray, float]:
    """Counts below dark, and dark, of sensors whose response is a power of the light."""
    full = tables.counts_max

    def response(light: FloatArray | float) -> FloatArray:
        share = np.clip(np.asarray(light) / full, 0.0, None)
        answer: FloatArray = full * share**senses.light_gamma
        return answer

    room = float(response(full - dark))
    return response(full - dark + lit) - room, full - room

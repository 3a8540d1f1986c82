"""Curves of one's own sensors as the tables that the embedded simulator looks readings up in.

A curve is a table of readings. Infrared before a flat wall: `distance` (m, from the sensor) and
`counts`; `incidence` (rad, from the wall's normal) and `sensor` (0 to 7) if they were varied. Light
of the lamp: `bearing` (rad, from the sensor's axis to the lamp) and `light` (counts below dark);
`distance` (m, from the lamp) if it was varied. Readings of one place may repeat: their median
counts, and their spread is the noise. What was not measured is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from realitygap.embedded_sim import SENSORS, InputError, Tables
from realitygap.embedded_sim.errors import LONGEST_NAME, shown
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.formats.headers import words_of
from realitygap.models.log.formats.units import SCALES, numbers
from realitygap.models.log.measured import read_table
from realitygap.models.log.tracker import NORMAL

NAMES = {
    **dict.fromkeys(("distance", "dist", "range"), "distance"),
    **dict.fromkeys(("incidence", "angle", "inclination"), "incidence"),
    **dict.fromkeys(("counts", "count", "reading", "infrared", "ir", "ps"), "counts"),
    **dict.fromkeys(("light", "ls"), "light"),
    "bearing": "bearing",
    "sensor": "sensor",
}
"""Words of a header, and what they say."""
KINDS = {"distance": "m", "incidence": "rad", "bearing": "rad"}
"""Columns that have a unit."""
FAR = 10.0
"""m: no infrared and no lamp of a small robot reaches further; beyond it is another unit."""
DISTANCES, INCIDENCES, BEARINGS = 48, 11, 72
"""Nodes of the tables, as many as those that come along have."""
REPEATS = 5
"""Readings of one place from which a spread is taken. Our choice."""
BRIGHT = 0.1
"""Share of the largest reading above which noise is taken as relative to it. Our choice."""
UNIFORM = np.sqrt(3.0)
"""Half width of a uniform distribution per standard deviation."""


class Curve(NamedTuple):
    """One curve as it was read."""

    name: str
    kind: str
    """`ps` or `ls`."""
    table: pd.DataFrame


def tables_of(paths: Sequence[Path], shipped: Tables) -> tuple[Tables, list[str]]:
    """The shipped tables with what was measured in its place.

    Args:
        paths: Curves, one of each kind at most.
        shipped: The tables that come along.

    Returns:
        The tables, and what was not measured, in sentences.

    Raises:
        InputError: a file is no curve, or there are two of one kind.
    """
    found, notes = shipped, []
    curves = [read_curve(path) for path in paths]
    for kind, name in (("ps", "infrared"), ("ls", "light")):
        own = [one for one in curves if one.kind == kind]
        if len(own) > 1:
            raise InputError(own[1].name, f"a second curve of {name}", "one of each kind")
        if not own:
            notes.append(f"no curve of {name}: the shipped e-puck's table is kept")
            continue
        found, said = (_infrared if kind == "ps" else _light)(own[0], found)
        notes += said
    return found.checked, notes


def read_curve(path: Path) -> Curve:
    """A curve by its headers.

    Raises:
        InputError: it cannot be read, lacks a column, or holds what no sensor reads.
    """
    raw = read_table(path)
    columns = {}
    for header in map(str, raw.columns):
        words, unit = words_of(header)
        name = NAMES.get("_".join(words), "")
        if not name or name in columns:
            continue
        field = f"{path.name}: {header}"
        values = numbers(raw[header], field)
        if not np.isfinite(values).all():
            raise InputError(field, "empty or infinite values", "a number in each row")
        scales = SCALES.get(KINDS.get(name, ""), {})
        if unit and unit not in scales:
            raise InputError(field, unit, f"one of {', '.join(scales) or 'no units'}")
        columns[name] = values * scales.get(unit, 1.0)
    table = pd.DataFrame(columns)
    kind = "ls" if "light" in table else "ps"
    needed = ("bearing", "light") if kind == "ls" else ("distance", "counts")
    if missing := [name for name in needed if name not in table]:
        listed = ", ".join(shown(name, LONGEST_NAME) for name in raw.columns)
        expected = "distance and counts, or bearing and light"
        raise InputError(path.name, f"no {' and '.join(missing)} among {listed}", expected)
    _check(path.name, kind, table)
    return Curve(path.name, kind, table)


def _check(name: str, kind: str, table: pd.DataFrame) -> None:
    """Refuse values that no sensor has, or that are in another unit."""
    if len(table) < 2:
        raise InputError(name, f"{len(table)} rows", "at least two readings")
    reading = "light" if kind == "ls" else "counts"
    limits = {
        "distance": (0.0, FAR, "metres, or a unit in the header, as distance_mm"),
        "incidence": (-np.pi / 2, np.pi / 2, "radians from the normal, or incidence_deg"),
        "bearing": (-2 * np.pi, 2 * np.pi, "radians from the sensor's axis, or bearing_deg"),
        reading: (0.0, 1e6, "counts from 0 on"),
        "sensor": (0.0, SENSORS - 1.0, f"whole numbers from 0 to {SENSORS - 1}"),
    }
    for column, (low, high, expected) in limits.items():
        values = table.get(column)
        if values is None:
            continue
        wrong = values[(values < low - 1e-9) | (values > high + 1e-9)]
        wrong = values[values % 1 != 0] if column == "sensor" and not len(wrong) else wrong
        if len(wrong):
            raise InputError(f"{name}: {column}", f"{wrong.iloc[0]:g}", expected)
    least = "bearing" if kind == "ls" else "distance"
    if table[least].nunique() < 2:
        raise InputError(f"{name}: {least}", "one value in every row", "several")


def _infrared(curve: Curve, base: Tables) -> tuple[Tables, list[str]]:
    """Tables with a measured infrared curve."""
    table, notes = curve.table, []
    reach = float(table["distance"].max())
    if "incidence" not in table:
        notes.append("infrared: no incidence, so that readings fall with its cosine")
    if "sensor" not in table:
        notes.append("infrared: no sensor, so that all eight are alike")
        every = [table] * SENSORS
    else:
        every = [table[table["sensor"] == k] for k in range(SENSORS)]
        absent = [str(k) for k, own in enumerate(every) if own["distance"].nunique() < 2]
        if absent:
            said = f"less than two distances of sensor {', '.join(absent)}"
            raise InputError(f"{curve.name}: sensor", said, "a curve of each, or no sensor column")
    counts = np.stack([_over_incidence(own, reach) for own in every])
    noise, floor = _spread(table, [n for n in ("sensor", "distance", "incidence") if n in table])
    if noise is None:
        notes.append("infrared: no reading repeats often enough; the shipped noise is kept")
    most = max(base.counts_max, float(table["counts"].max()))
    found = replace(
        base,
        ps_counts=counts.astype(np.float32),
        ps_range=reach,
        ps_noise=base.ps_noise if noise is None else np.full(SENSORS, noise),
        ps_noise_floor=base.ps_noise_floor if floor is None else floor,
        counts_max=most,
    )
    return found, notes


def _over_incidence(table: pd.DataFrame, reach: float) -> FloatArray:
    """(distances, incidences) counts of one sensor on the table's axes; 0 of a grazing wall."""
    distances = reach * np.linspace(0.0, 1.0, DISTANCES) ** 2
    cosines = np.linspace(0.0, 1.0, INCIDENCES)
    if "incidence" not in table:
        return np.outer(_curve(table, "distance", "counts", distances), cosines)
    measured = table.assign(cosine=np.cos(table["incidence"]).round(9))
    known = np.unique(measured["cosine"].to_numpy(dtype=float))
    known = known[known > 0.0]
    rows = [
        _curve(measured[measured["cosine"] == c], "distance", "counts", distances) for c in known
    ]
    known = np.array([0.0, *known])
    values = np.stack([np.zeros(DISTANCES), *rows])
    return np.stack([np.interp(cosines, known, column) for column in values.T])


def _light(curve: Curve, base: Tables) -> tuple[Tables, list[str]]:
    """Tables with a measured light curve."""
    table = curve.table.assign(bearing=np.remainder(curve.table["bearing"] + np.pi, 2 * np.pi))
    bearings = 2 * np.pi * np.arange(BEARINGS) / BEARINGS  # from -pi on, as the table is
    notes = []
    if "distance" not in table:
        notes.append("light: no distance, so that light falls with it as in the shipped table")
        ring = _curve(table, "bearing", "light", bearings, period=2 * np.pi)
        largest = float(ring.max())
        if largest <= 0.0:
            raise InputError(f"{curve.name}: light", "no light at all", "counts below dark")
        counts = np.outer(base.ls_counts.max(axis=1), ring / largest)
        reach = base.ls_range
    else:
        reach = float(table["distance"].max())
        nodes = reach * np.linspace(0.0, 1.0, DISTANCES) ** 2
        known = np.unique(table["distance"].to_numpy(dtype=float))
        if len(known) < 2:
            raise InputError(f"{curve.name}: distance", "one value", "several, or no such column")
        rings = [
            _curve(table[table["distance"] == d], "bearing", "light", bearings, period=2 * np.pi)
            for d in known
        ]
        values = np.stack(rings)
        counts = np.stack([np.interp(nodes, known, column) for column in values.T], axis=1)
    keys = [name for name in ("distance", "bearing") if name in table]
    noise = _floor(table.rename(columns={"light": "counts"}), keys)
    if noise is None:
        notes.append("light: no reading repeats often enough; the shipped noise is kept")
    found = replace(
        base,
        ls_counts=counts.astype(np.float32),
        ls_range=reach,
        ls_dark=max(base.ls_dark, float(counts.max())),
        ls_noise=base.ls_noise if noise is None else noise,
    )
    return found, notes


def _curve(
    table: pd.DataFrame, by: str, reading: str, nodes: FloatArray, period: float | None = None
) -> FloatArray:
    """(nodes,) medians of readings, straight in between, held beyond the ends."""
    medians = table.groupby(by)[reading].median()
    at, values = medians.index.to_numpy(dtype=float), medians.to_numpy(dtype=float)
    found: FloatArray = np.interp(nodes, at, values, period=period)
    return found


def _spread(table: pd.DataFrame, keys: list[str]) -> tuple[float | None, float | None]:
    """Half widths of uniform noise: relative to bright readings, and of the darkest place."""
    medians, spread = _places(table, keys)
    if not len(medians):
        return None, None
    bright = medians > BRIGHT * medians.max()
    relative = spread[bright] / medians[bright]
    return float(np.median(relative)) if len(relative) else None, _floor(table, keys)


def _floor(table: pd.DataFrame, keys: list[str]) -> float | None:
    """Half width of uniform noise of the darkest place with repeated readings."""
    medians, spread = _places(table, keys)
    return float(spread[medians.argmin()]) if len(medians) else None


def _places(table: pd.DataFrame, keys: list[str]) -> tuple[FloatArray, FloatArray]:
    """(places,) median and half width of uniform noise where readings repeat often enough."""
    own = [part["counts"].to_numpy(dtype=float) for _, part in table.groupby(keys)]
    often = [values for values in own if len(values) >= REPEATS]
    medians = np.array([np.median(values) for values in often])
    spread = [np.median(np.abs(values - np.median(values))) for values in often]
    return medians, UNIFORM * NORMAL * np.array(spread)

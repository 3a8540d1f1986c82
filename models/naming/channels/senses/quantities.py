"""What readings may follow: every measured quantity, as functions of rows or of single readings."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim import SENSORS, PointModel
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.senses.sight import Sight

QUANTITIES = {
    "always": "everywhere and all the time",
    "level": "how much they read",
    "sensor": "which sensor it is",
    "heading": "which way the sensor faces",
    "bearing": "where the lamp or the wall is as seen from the sensor",
    "distance": "how far the lamp or the wall is",
    "place": "where in the arena the robot is",
    "radius": "how far from the arena's middle the robot is",
    "point": "how near one point of the arena is",
    "time": "how long the log has lasted",
    "speed": "how fast the robot is told to drive",
    "turning": "how fast the robot is told to turn",
    "turn_side": "to which side the robot is told to turn",
    "neighbour": "how near the next robot is",
    "food": "whether the robot is on food",
    "nest": "whether the robot is in the nest",
    "noise": "whatever is before them",
    "bearing_nest": "where around the nest it is",
    "distance_nest": "how far from the nest's middle it is",
}
"""In words."""

SPOT, SPACING = 0.12, 0.24
"""m: width of a point's surroundings, and how far apart points are tried. No rule: which
columns there are."""
LONGEST, FASTEST, SLOWEST = 120.0, 24, 3
"""s, and the numbers of swings in it that are tried: periods of 5 to 40 s.
No rule: which columns there are."""
DIM = 10.0
"""counts below which readings differ by noise alone. No rule: of the sensor."""

Key = tuple[str, str]
"""Quantity, and which of its functions."""


def of_rows(sight: Sight, model: PointModel) -> dict[Key, FloatArray]:
    """(rows,) values of what a whole robot has at a moment."""
    x, y = sight.poses[:, 0], sight.poses[:, 1]
    values: dict[Key, FloatArray] = {
        ("always", ""): np.ones_like(x),
        ("place", " x"): x,
        ("place", " y"): y,
        ("radius", ""): np.hypot(x, y),
        ("time", ""): sight.time,
        ("speed", ""): np.abs(sight.commanded[:, 0]),
        ("turning", ""): np.abs(sight.commanded[:, 1]),
        ("turn_side", ""): np.sign(sight.commanded[:, 1]),
    }
    for px, py in _points(model.arena_radius):
        away = (x - px) ** 2 + (y - py) ** 2
        values["point", f" ({1e3 * px:.0f}, {1e3 * py:.0f}) mm"] = np.exp(-0.5 * away / SPOT**2)
    for swings in range(SLOWEST, FASTEST + 1):
        period = LONGEST / swings
        phase = 2.0 * np.pi * sight.time / period
        values["time", f" sin {swings} in two minutes"] = np.sin(phase)
        values["time", f" cos {swings} in two minutes"] = np.cos(phase)
    place = sight.neighbours.place
    if place.shape[1] > 1:
        apart = np.hypot(place[..., 0] - x[:, None], place[..., 1] - y[:, None]).min(axis=1)
        values["neighbour", ""] = np.exp(
            -np.maximum(apart - 2.0 * model.body_radius, 0.0) / sight.rules.near
        )
    for name, state in sight.states.items():
        values[name, ""] = state
    return values


def of_readings(
    sight: Sight, model: PointModel, signal: FloatArray, *, light: bool
) -> dict[Key, FloatArray]:
    """(rows, 8) values of what each sensor has for itself; `signal` (rows, 8) counts expected."""
    yaw = sight.poses[:, 2:3] + np.asarray(model.sensor_angles)
    px = sight.poses[:, 0:1] + model.body_radius * np.cos(yaw)
    py = sight.poses[:, 1:2] + model.body_radius * np.sin(yaw)
    values = {
        ("level", ""): np.log(np.maximum(signal, 0.0) + DIM),
        ("heading", " sin"): np.sin(yaw),
        ("heading", " cos"): np.cos(yaw),
    }
    for k in range(SENSORS):
        values["sensor", f" {k}"] = np.broadcast_to(np.arange(SENSORS) == k, yaw.shape).astype(
            float
        )
    there = _lamp(sight, model, px, py) if light else _wall(model, px, py)
    if there is not None:
        toward, distance = there
        bearing = toward - yaw
        values["distance", ""] = np.log(np.maximum(distance, 0.005))
        for turns, word in ((1, ""), (2, " twice")):
            values["bearing", f" sin{word}"] = np.sin(turns * bearing)
            values["bearing", f" cos{word}"] = np.cos(turns * bearing)
    return values


def _points(radius: float) -> list[tuple[float, float]]:
    """A triangular grid over the arena."""
    steps = range(-5, 6)
    grid = [(SPACING * (i + 0.5 * (j % 2)), SPACING * 0.866 * j) for i in steps for j in steps]
    return [(x, y) for x, y in grid if np.hypot(x, y) < radius]


def _lamp(
    sight: Sight, model: PointModel, px: FloatArray, py: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Direction (rad) and distance (m) of the lamp; None where no lamp is lit."""
    lamps = np.array([lamp or (np.nan, np.nan) for lamp in model.lamps])
    at = lamps[np.maximum(sight.scenario, 0)]
    if not np.isfinite(at).any():
        return None
    x, y = at[:, :1] - px, at[:, 1:] - py
    return np.nan_to_num(np.arctan2(y, x)), np.nan_to_num(np.hypot(x, y), nan=1.0)


def _wall(model: PointModel, px: FloatArray, py: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Direction (rad) and distance (m) of the nearest part of the wall."""
    return np.arctan2(py, px), model.arena_radius - np.hypot(px, py)

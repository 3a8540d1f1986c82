"""Sensor readings as something to look at: how far infrared seems to see, how bright it is."""

from __future__ import annotations

import numpy as np

from realitygap.embedded_sim import PointModel, Tables
from realitygap.embedded_sim.model import FloatArray

ABOVE = 3.0
"""Times the tables' noise floor from which on infrared counts as seeing something; our choice."""
USUAL, LARGEST = 50.0, 99.9
"""Percentiles of all readings that stand for seeing nothing and for touching, where no table says
what a reading means. Our choice: robots mostly see nothing, and outliers are few."""
FAINT = 0.05
"""Share of that range below which nothing is drawn; our choice."""


def reach(model: PointModel) -> float:
    """m that infrared sees at most; without tables the length of the ray that is drawn at most."""
    return 2.0 * model.body_radius if model.tables is None else model.tables.ps_range


def rays(counts: FloatArray, model: PointModel) -> FloatArray:
    """How far away what each infrared sensor reads would stand.

    Args:
        counts: (..., 8) readings.
        model: With its tables a reading is the distance of a wall that faces the sensor; without,
            the higher a reading is among the others, the shorter the ray.

    Returns:
        (..., 8) m from the body; NaN: it sees nothing.
    """
    if model.tables is not None:
        return _distances(counts, model.tables)
    known = counts[np.isfinite(counts)]
    low, high = np.percentile(known, (USUAL, LARGEST)) if len(known) else (0.0, 0.0)
    strength = (counts - low) / (high - low) if high > low else np.zeros_like(counts)
    length: FloatArray = reach(model) * (1.0 - np.clip(strength, 0.0, 1.0))
    return np.where(strength > FAINT, length, np.nan)


def _distances(counts: FloatArray, tables: Tables) -> FloatArray:
    """(..., 8) m, by each sensor's table for a wall at right angles."""
    found = np.full(counts.shape, np.nan)
    facing = tables.ps_counts[:, :, -1].astype(float)
    distance = tables.ps_range * np.linspace(0.0, 1.0, facing.shape[1]) ** 2
    for sensor, falling in enumerate(facing):
        order = np.argsort(falling, kind="stable")
        found[..., sensor] = np.interp(counts[..., sensor], falling[order], distance[order])
    nothing = ~(counts > ABOVE * tables.ps_noise_floor)
    found[nothing | (found >= tables.ps_range)] = np.nan
    return found


def brightness(counts: FloatArray, model: PointModel) -> FloatArray | None:
    """(..., 8) from 0, dark, to 1, as bright as the tables know; None: nothing is known of light.

    Args:
        counts: (..., 8) readings, which fall with light.
        model: With tables.
    """
    if model.tables is None or not np.isfinite(counts).any():
        return None
    dark, most = model.tables.ls_dark, float(model.tables.ls_counts.max())
    return np.clip((dark - np.nan_to_num(counts, nan=dark)) / most, 0.0, 1.0)

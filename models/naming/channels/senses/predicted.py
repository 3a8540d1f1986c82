"""What the point model's sensors read at the rows of a log, and how far off they may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtr

from realitygap.embedded_sim import SENSORS, PointModel, readings
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.senses import Belief
from realitygap.models.log.tracker import NORMAL
from realitygap.models.naming.channels.senses.path import Path
from realitygap.models.naming.channels.senses.sight import Bools, Rows, Sight

UNIFORM = 3.0**-0.5
"""Standard deviation of a uniform variable relative to its half width. No rule: of statistics."""
TELLING = 20.0
"""counts that must be expected for an infrared reading to tell of noise: five times what a reading
of nothing scatters. No rule: of the sensor."""
LEAST_TELLING = 60
"""Such readings from which a scale is told. No rule: fewer do not tell a scatter to a tenth."""
TABLE_ERROR = 0.01
"""Relative standard deviation of what a captured table and its interpolation get wrong.
No rule: of the tables."""


def predict(
    sight: Sight, model: PointModel, beliefs: Sequence[Belief], robots: Sequence[int] | None = None
) -> FloatArray:
    """(rows, 16) counts expected; rows of other robots than those asked for are 0.

    Args:
        sight: Where and when.
        model: Before anything believed of single robots.
        beliefs: One per robot.
        robots: Indices; None: all.
    """
    result = np.zeros(sight.read.shape)
    alike: dict[Belief, list[int]] = {}
    for k in range(len(sight.robots)) if robots is None else robots:
        alike.setdefault(beliefs[k], []).append(k)
    for belief, group in alike.items():
        if len(group) == len(sight.robots):
            return told(sight, model, belief, np.arange(len(sight.time)))
        rows = np.concatenate([np.arange(*sight.begin[k : k + 2]) for k in group])
        result[rows] = told(sight, model, belief, rows)
    return result


def told(sight: Sight, model: PointModel, belief: Belief, rows: Rows) -> FloatArray:
    """(rows, 16) counts expected by one belief; with memory, of everything that came before."""
    counts = read(sight, belief.of(model), rows)
    if not belief.memory:
        return counts
    path, run, time = sight.path or sight, sight.run[rows], sight.time[rows]
    for one in np.unique(run):
        whole = np.flatnonzero(path.run == one)
        plain = read(path, belief.of(model), whole)
        later = plain
        for memory in belief.memory:
            later = memory(later, path.time[whole])
        here = run == one
        counts[here] += (later - plain)[np.searchsorted(path.time[whole], time[here])]
    return counts


def read(sight: Sight | Path, model: PointModel, rows: Rows) -> FloatArray:
    """(rows, 16) counts expected by one model."""
    assert model.tables is not None
    scenario = np.maximum(sight.scenario[rows], 0)
    both = readings(sight.poses[rows], scenario, sight.time[rows], model=model)
    return np.hstack([_never_below_zero(both.ps, model), both.ls])


def _never_below_zero(counts: FloatArray, model: PointModel) -> FloatArray:
    """Mean of infrared readings whose noise is cut off at zero, taken for normal."""
    assert model.tables is not None
    sd = max(model.senses.ps_noise * model.tables.ps_noise_floor * UNIFORM, 1e-9)
    near = counts <= 5.0 * sd
    few = counts[near]
    z = few / sd
    mean = counts.copy()
    mean[near] = few * ndtr(z) + sd * np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi)
    dead = (np.array(model.senses.ps_gain) == 0.0) & (np.array(model.senses.ps_offset) == 0.0)
    mean[:, dead] = 0.0  # nor has it any noise
    return mean


def own_noise(
    sight: Sight, model: PointModel, beliefs: Sequence[Belief], counts: FloatArray
) -> FloatArray:
    """(rows, 16) standard deviation of the sensors' own noise where `counts` are expected."""
    tables = model.tables
    assert tables is not None
    scale = np.array([belief.senses.ps_noise for belief in beliefs])[sight.robot][:, None]
    ambient = np.array([belief.senses.ps_offset for belief in beliefs])[sight.robot]
    seen = np.maximum(counts[:, :SENSORS] - ambient, 0.0)
    infrared = scale * UNIFORM * np.hypot(tables.ps_noise * seen, tables.ps_noise_floor)
    return np.hstack([infrared, np.full((len(counts), SENSORS), UNIFORM * tables.ls_noise)])


def noise(
    sight: Sight, model: PointModel, beliefs: Sequence[Belief], counts: FloatArray
) -> FloatArray:
    """(rows, 16) standard deviation of readings about what is predicted, `counts`."""
    assert model.tables is not None
    lit = np.abs(model.tables.ls_dark - counts[:, SENSORS:])
    variance = own_noise(sight, model, beliefs, counts) ** 2
    variance[:, SENSORS:] += (TABLE_ERROR * lit) ** 2
    for axis in range(3):
        moved = sight.poses.copy()
        moved[:, axis] += sight.spread[:, axis]
        variance += (predict(replace(sight, poses=moved), model, beliefs) - counts) ** 2
    return np.asarray(np.sqrt(variance + 1.0 / 12.0))


def noise_scale(sight: Sight, residual: FloatArray, expected: FloatArray, use: Bools) -> FloatArray:
    """(robots,) logarithm of the scale of infrared errors; NaN where too little was seen.

    Args:
        sight: The log's.
        residual: (rows, 16) errors in noise.
        expected: (rows, 16) counts: the strong readings are judged.
        use: (rows, 16) which are judged.
    """
    value = np.full(len(sight.robots), np.nan)
    for k in range(len(sight.robots)):
        rows = sight.rows_of(k)
        errors = residual[rows, :SENSORS]
        errors = errors[use[rows, :SENSORS] & (expected[rows, :SENSORS] > TELLING)]
        if len(errors) >= LEAST_TELLING:
            value[k] = np.log(NORMAL * np.median(np.abs(errors - np.median(errors))))
    return value

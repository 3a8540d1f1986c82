"""Fits of linear terms: covariances from blocks."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import hadamard

from realitygap.embedded_sim.model import FloatArray
from tests.models.toys import fit_motion

SMALL = 0.01
"""Errors, in noise, at which robust errors are as good as Gaussian."""


def ordinary(y: FloatArray, x: FloatArray) -> FloatArray:
    """(logs, p) least squares of each log."""
    flat = x.reshape(len(x), -1, x.shape[3])
    logs = zip(flat, y, strict=True)
    return np.stack([np.linalg.lstsq(a, b.ravel(), rcond=None)[0] for a, b in logs])


def test_a_variance_from_few_blocks_is_that_of_the_fit() -> None:
    """Of eight blocks four terms leave four degrees of freedom, and blocks are what scatters."""
    random = np.random.default_rng(3)
    logs, blocks, rows, size, wide = 400, 8, 100, 4, 0.2
    y = np.repeat(wide * random.normal(size=(logs, blocks, 1)), rows, axis=2)
    design = hadamard(blocks)[:, 1 : size + 1].astype(float)
    x = np.broadcast_to(design[None, :, None, :], (logs, blocks, rows, size))
    found = fit_motion(y, x)
    told = np.einsum("gpp->gp", found.covariance)
    assert found.value.var() == pytest.approx(wide**2 / blocks, rel=0.15)
    assert told.mean() == pytest.approx(wide**2 / blocks, rel=0.1)
    held = (np.abs(found.value) < 1.96 * np.sqrt(told)).mean()
    expected = 1.0 - 2.0 * stats.t.sf(1.96, blocks - size)
    assert held == pytest.approx(expected, abs=0.03)


def test_a_95_per_cent_interval_holds_the_truth_in_95_per_cent_of_logs() -> None:
    """Half of the errors' variance is a whole block's: rows are far from independent. Errors are of
    the size at which the engine takes its weights for its curvature."""
    random = np.random.default_rng(4)
    logs, blocks, truth, rows, wide = 800, 40, 0.7, 60, 0.2
    y = wide * random.normal(size=(logs, blocks, rows))
    y += wide * random.normal(size=(logs, blocks, 1))
    x = random.choice([-1.0, 1.0], (logs, blocks, 1, 1)) + np.zeros((logs, blocks, rows, 1))
    found = fit_motion(y + truth * x[..., 0], x)
    away = np.abs(found.value - truth)[:, 0] / np.sqrt(found.covariance[:, 0, 0])
    assert (away < 1.96).mean() == pytest.approx(0.95, abs=0.03)
    assert (away < 1.0).mean() == pytest.approx(0.68, abs=0.07)


def test_a_covariance_is_never_less_than_white_noise_leaves() -> None:
    """In blocks whose errors happen to cancel nothing scatters."""
    random = np.random.default_rng(5)
    y = 0.3 * random.normal(size=(6, 10, 10))
    y -= y.mean(axis=2, keepdims=True)
    x = np.repeat(random.normal(size=(6, 10, 1, 1)), 10, axis=2)
    found = fit_motion(y, x)
    assert (found.covariance[:, 0, 0] > 0.8 / (x**2).sum(axis=(1, 2, 3))).all()

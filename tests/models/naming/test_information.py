"""Steps and errors of fits to data that do not tell every parameter."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.information import inverted

QUIET = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
SIZES = st.integers(0, 6)
SEEDS = st.integers(0, 2**31)


def drawn(seed: int, size: int, rows: int = 40) -> FloatArray:
    """(rows, size) columns, in units that differ by orders of magnitude."""
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    return np.asarray(rng.normal(0.0, 1.0, (rows, size)) * 10.0 ** rng.uniform(-1.0, 1.0, size))


@QUIET
@given(SEEDS, SIZES)
def test_where_everything_is_told_it_is_the_inverse(seed: int, size: int) -> None:
    columns = drawn(seed, size)
    information = columns.T @ columns
    found = inverted(information)
    assert found.told.all()
    assert found.covariance == pytest.approx(np.linalg.inv(information), rel=1e-6)


@QUIET
@given(SEEDS, st.integers(1, 5), st.data())
def test_a_column_without_effect_has_no_step_an_infinite_error_and_leaves_the_others(
    seed: int, size: int, data: st.DataObject
) -> None:
    rest = drawn(seed, size)
    at = data.draw(st.integers(0, size))
    columns = np.insert(rest, at, 0.0, axis=1)
    gradient = columns.T @ np.random.default_rng(seed).normal(size=len(columns))
    found, alone = inverted(columns.T @ columns), inverted(rest.T @ rest)
    others = np.delete(np.arange(size + 1), at)
    assert found.told.tolist() == [k != at for k in range(size + 1)]
    assert found.step(gradient)[at] == 0.0
    assert found.step(gradient)[others] == pytest.approx(alone.step(gradient[others]), rel=1e-6)
    covariance = found.sandwich(columns.T @ columns)
    assert covariance[at, at] == np.inf
    assert not covariance[at, others].any()
    assert covariance[np.ix_(others, others)] == pytest.approx(alone.covariance, rel=1e-5)


@QUIET
@given(SEEDS, st.integers(0, 4), st.floats(1e-2, 1e2))
def test_of_two_columns_that_are_alike_neither_is_told_but_their_sum_is_fitted(
    seed: int, size: int, ratio: float
) -> None:
    rest = drawn(seed, size + 1)
    columns = np.column_stack([rest, ratio * rest[:, -1]])
    errors = columns @ np.ones(columns.shape[1])
    found = inverted(columns.T @ columns)
    assert found.told.tolist() == [True] * size + [False, False]
    left = errors - columns @ found.step(columns.T @ errors)
    assert np.abs(left).max() < 1e-5 * np.abs(errors).max()
    covariance = found.sandwich(np.zeros_like(columns.T @ columns))
    assert np.isinf(np.diag(covariance)).tolist() == [False] * size + [True, True]


@QUIET
@given(SEEDS, st.integers(1, 4))
def test_blocks_never_make_errors_smaller_than_white_ones(seed: int, size: int) -> None:
    columns = drawn(seed, size)
    found = inverted(columns.T @ columns)
    few = columns[:3]
    told = np.diag(found.sandwich(few.T @ few * 1e-3))
    assert (told >= np.diag(found.covariance) * (1.0 - 1e-9)).all()

"""What is integrated out and what is fitted, against the same with whole covariance matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.marginal import (
    FLAT,
    Prior,
    Scored,
    beside,
    freed,
    integrated,
    root_of,
    shared,
)
from realitygap.models.naming.engine.state import SWARM, Kept
from realitygap.models.naming.engine.weighed import Weighed
from tests.models.linear import cause, flexible, item, sound, state_of

QUIET = settings(deadline=None, derandomize=True, max_examples=40)
SEEDS, SIZES = st.integers(0, 2**31), st.integers(1, 5)
ROWS = 50


def drawn(seed: int, size: int, robots: int = 1) -> tuple[FloatArray, FloatArray]:
    """(robots, ROWS) errors and (robots, ROWS, size) columns in units that differ."""
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    x = rng.normal(size=(robots, ROWS, size)) * 10.0 ** rng.uniform(-1.0, 1.0, size)
    return 3.0 * rng.normal(size=(robots, ROWS)), x


def covariance_of(seed: int, size: int) -> FloatArray:
    """(size, size), singular where it has more than one column."""
    root = np.random.default_rng(seed).normal(size=(size, max(size - 1, 1)))
    return root @ root.T


def score_of(y: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    return x.T @ x, x.T @ y, float(y @ y)


def same(found: Scored, x: FloatArray, y: FloatArray, covariance: FloatArray) -> None:
    """A score is what generalised least squares has."""
    inverse = np.linalg.inv(covariance)
    scale = np.linalg.norm(x, axis=0)
    w, t = x.T @ inverse @ x, x.T @ inverse @ y
    assert found.information == pytest.approx(w, rel=1e-7, abs=1e-7 * scale.max() ** 2)
    assert found.slope == pytest.approx(t, rel=1e-7, abs=1e-7 * scale.max() * np.linalg.norm(y))
    assert found.square == pytest.approx(float(y @ inverse @ y), rel=1e-7)


@QUIET
@given(SEEDS, SIZES, st.data())
def test_differences_integrated_out_are_a_covariance(
    seed: int, size: int, data: st.DataObject
) -> None:
    (y,), (x,) = drawn(seed, size)
    some = data.draw(st.integers(1, size))
    at, mean = np.arange(some), np.random.default_rng(seed).normal(size=some)
    wide = covariance_of(seed, some)
    found = integrated(*score_of(y, x), Prior(at, mean, root_of(wide)))
    own = x[:, :some]
    same(found, x, y - own @ mean, np.eye(ROWS) + own @ wide @ own.T)


@QUIET
@given(SEEDS, SIZES, st.booleans())
def test_what_is_freed_is_regressed_out_though_two_columns_are_alike(
    seed: int, size: int, alike: bool
) -> None:
    (y,), (x,) = drawn(seed, size + 1)
    free = x[:, :size]
    if alike:
        free = np.column_stack([free, 3.0 * free[:, 0]])
    whole = np.column_stack([free, x[:, size]])
    found = freed(Scored(*score_of(y, whole)), np.arange(free.shape[1]))
    left = y - free @ np.linalg.lstsq(free, y, rcond=None)[0]
    last = x[:, size] - free @ np.linalg.lstsq(free, x[:, size], rcond=None)[0]
    assert found.square == pytest.approx(float(left @ left), rel=1e-7)
    assert found.information[-1, -1] == pytest.approx(float(last @ last), rel=1e-6)
    assert found.slope[-1] == pytest.approx(float(last @ left), rel=1e-6, abs=1e-6)


def test_nothing_freed_changes_nothing() -> None:
    (y,), (x,) = drawn(1, 2)
    score = Scored(*score_of(y, x))
    assert freed(score, np.array([], dtype=np.int64)) is score


def joint(x: FloatArray, wide: FloatArray, spread: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(all rows, k) columns of all robots and the covariance of their errors."""
    robots, rows, _ = x.shape
    whole = x.reshape(robots * rows, -1)
    covariance = np.eye(robots * rows) + whole @ np.diag(spread**2) @ whole.T
    for k in range(robots):
        part = slice(k * rows, (k + 1) * rows)
        covariance[part, part] += x[k] @ wide @ x[k].T
    return whole, covariance


@QUIET
@given(SEEDS, st.integers(1, 3), st.integers(1, 4))
def test_a_swarms_score_and_a_robots_beside_it_are_those_of_the_joint_model(
    seed: int, size: int, robots: int
) -> None:
    y, x = drawn(seed, size, robots)
    wide = covariance_of(seed, size)
    spread = np.abs(np.random.default_rng(seed).normal(size=size))
    spread[0] *= seed % 2
    prior = Prior(np.arange(size), np.zeros(size), root_of(wide))
    alone = [integrated(*score_of(a, b), prior) for a, b in zip(y, x, strict=True)]
    common = shared(alone, spread)
    whole, covariance = joint(x, wide, spread)
    same(common.total, whole, y.ravel(), covariance)
    inverse = np.linalg.inv(covariance)
    for k in range(robots):
        own = np.zeros_like(whole)
        own[k * ROWS : (k + 1) * ROWS] = x[k]
        found, scale = beside(alone[k], common), np.abs(own.T @ own).max()
        assert found.information == pytest.approx(own.T @ inverse @ own, abs=1e-8 * scale)
        assert found.slope == pytest.approx(own.T @ inverse @ y.ravel(), abs=1e-7 * scale)


def test_what_a_swarm_shares_without_bound_is_fitted() -> None:
    y, x = drawn(2, 2, 3)
    none = Prior(np.array([], dtype=np.int64), np.zeros(0), np.zeros((0, 0)))
    alone = [integrated(*score_of(a, b), none) for a, b in zip(y, x, strict=True)]
    size = np.sqrt(np.sum([np.diag(one.information) for one in alone], axis=0))
    found = shared(alone, FLAT / size).total.square
    flat = x.reshape(-1, 2)
    left = y.ravel() - flat @ np.linalg.lstsq(flat, y.ravel(), rcond=None)[0]
    assert found == pytest.approx(float(left @ left), rel=1e-6)


A, B = cause("a"), cause("b")
ITEMS = (item(A, 0), item(B, 1), flexible("heading", 2, 3))
NAMES = ("a.p0", "b.p0", "speed/heading 0", "speed/heading 1")
DIFFER, ALIKE = (0.3, 0.2, 0.1, 0.4), (0.2, 0.0, 0.3, 0.1)


def healthy() -> Health:
    """Causes a and b hang together."""
    made = sound(NAMES, DIFFER, ALIKE)
    made.covariance[0, 1] = made.covariance[1, 0] = 0.05
    made.mean[:] = (0.3, -0.1, 0.2, 0.0)
    return made


def test_a_robots_fit_is_that_of_the_joint_model_with_its_swarm_known() -> None:
    """Of its causes' values, errors and deviance, given what the others say of the swarm."""
    y, x = drawn(3, 4, 3)
    x /= np.linalg.norm(x, axis=1, keepdims=True) / 4.0
    health = healthy()
    fit = Fitter(Weighed(state_of(y, x, ITEMS, health)), 1).fit((A,), [np.zeros(1)])
    assert fit is not None
    whole, covariance = joint(x, health.covariance, np.sqrt(health.swarm))
    left = y.ravel() - whole @ health.mean
    own = np.zeros(3 * ROWS)
    own[ROWS : 2 * ROWS] = x[1, :, 0]
    inverse = np.linalg.inv(covariance)
    weight = own @ inverse @ own
    others = np.r_[0:ROWS, 2 * ROWS : 3 * ROWS]
    rest = left[others] @ np.linalg.inv(covariance[np.ix_(others, others)]) @ left[others]
    assert fit.coordinates[0] == pytest.approx([own @ inverse @ left / weight], rel=1e-5)
    assert fit.covariance == pytest.approx(np.array([[1.0 / weight]]), rel=1e-5)
    told = left @ inverse @ left - (own @ inverse @ left) ** 2 / weight - rest
    assert fit.square == pytest.approx(told, rel=1e-6)


def test_a_swarms_fit_is_that_of_the_joint_model() -> None:
    y, x = drawn(4, 4, 3)
    x /= np.linalg.norm(x, axis=1, keepdims=True) / 4.0
    health = healthy()
    fit = Fitter(Weighed(state_of(y, x, ITEMS, health)), SWARM).fit((A, B), [np.zeros(1)] * 2)
    assert fit is not None
    whole, covariance = joint(x, health.covariance, np.sqrt(health.swarm))
    left, inverse = y.ravel() - whole @ health.mean, np.linalg.inv(covariance)
    own = whole[:, :2]
    wide = np.linalg.inv(own.T @ inverse @ own)
    value = wide @ own.T @ inverse @ left
    assert np.concatenate(fit.coordinates) == pytest.approx(value, rel=1e-5)
    assert fit.covariance == pytest.approx(wide, rel=1e-5)
    least = left @ inverse @ left - value @ own.T @ inverse @ left
    assert fit.square == pytest.approx(float(least), rel=1e-6)


def test_of_what_is_kept_in_a_swarm_the_rest_is_scored_beside() -> None:
    """A flexible term that all robots have is fitted for all of them together."""
    y, x = drawn(5, 4, 3)
    x /= np.linalg.norm(x, axis=1, keepdims=True) / 4.0
    state = state_of(y, x, ITEMS, healthy())
    state.kept[SWARM] = (Kept(ITEMS[2], np.zeros(0)),)
    found = Weighed(state).score(SWARM)
    whole, covariance = joint(x, healthy().covariance, np.sqrt(healthy().swarm))
    inverse = np.linalg.inv(covariance)
    left = y.ravel() - whole @ healthy().mean
    free, a = whole[:, 2:], whole[:, 0]
    wide = np.linalg.inv(free.T @ inverse @ free)
    turned = inverse - inverse @ free @ wide @ free.T @ inverse
    assert found.information[0, 0] == pytest.approx(float(a @ turned @ a), rel=1e-5)
    assert found.slope[0] == pytest.approx(float(a @ turned @ left), rel=1e-4, abs=1e-4)
    assert Weighed(state).with_flexible(SWARM).information[2, 2] > 1.0


@pytest.mark.parametrize("scope", [0, SWARM], ids=["robot", "swarm"])
def test_a_95_per_cent_interval_holds_the_part_in_95_per_cent_of_logs(scope: int) -> None:
    """Robots differ in the cause itself and in another that resembles it, and so do swarms."""
    random = np.random.default_rng(6)
    robots, logs, truth = 4, 200, 1.5
    health, held = healthy(), 0
    x = random.normal(size=(robots, ROWS, 4))
    x[:, :, 1] += 0.7 * x[:, :, 0]
    for _ in range(logs):
        common = health.mean + np.sqrt(health.swarm) * random.normal(size=4)
        each = common + random.multivariate_normal(np.zeros(4), health.covariance, robots)
        ill = np.ones(robots, dtype=bool) if scope == SWARM else np.arange(robots) == scope
        each[:, 0] += truth * ill
        y = np.einsum("rnk,rk->rn", x, each) + random.normal(size=(robots, ROWS))
        fit = Fitter(Weighed(state_of(y, x, ITEMS, health)), scope).fit((A,), [np.zeros(1)])
        assert fit is not None
        held += abs(fit.coordinates[0][0] - truth) < 1.96 * np.sqrt(fit.covariance[0, 0])
    assert held / logs == pytest.approx(0.95, abs=0.03)

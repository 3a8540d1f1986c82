"""Nothing is believed on one window's word, in robots that are linear and in real channels."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming import verdict
from realitygap.models.naming.engine.loudest import given, of_a_moment, without_loudest
from realitygap.models.naming.engine.search import search
from realitygap.models.naming.engine.state import SWARM, State, with_kept
from realitygap.models.naming.engine.weighed import Weighed
from tests.models.linear import state_of
from tests.models.naming.test_naming_search import (
    GATES,
    ITEMS,
    KNOWN,
    ROBOTS,
    columns,
    health_of,
    said,
)

ILL = 3
FLEXIBLE = 3
"""The column that follows the heading."""


def told(size: float, column: int, *, in_one: bool) -> State:
    """A robot with some of a column, in all of its windows or in the one that shows most of it."""
    x = columns(11)
    y = np.random.default_rng(11).normal(size=x.shape[:2])
    state = state_of(y, x, ITEMS, health_of(0.5, 0.5))
    change: FloatArray = size * x[ILL, :, column]
    if in_one:
        by_window = state.robots[ILL].by_window(change**2)
        window = np.repeat(np.arange(len(by_window)), len(change) // len(by_window))
        change = np.where(window == int(np.argmax(by_window)), change, 0.0)
        change *= size / np.sqrt(change @ change)
    y[ILL] += change
    return state_of(y, x, ITEMS, health_of(0.5, 0.5))


def judged(state: State) -> set[tuple[int, str]]:
    """Causes that stand, by scope."""
    state, found = verdict.settle(search(state, GATES, KNOWN), GATES, KNOWN)
    return {(scope, term.key) for scope, one in found.items() for term in one.terms}


@pytest.mark.parametrize("size", [9.0, 40.0])
def test_a_cause_that_all_windows_show_stands(size: float) -> None:
    assert judged(told(size, 0, in_one=False)) == {(ILL, "a")}


def test_a_cause_that_one_window_shows_is_not_named_however_loud_that_is() -> None:
    state = told(40.0, 0, in_one=True)
    assert (ILL, "a") in said(search(state, GATES, KNOWN)), "it passes the gate"
    assert judged(state) == set()


@pytest.mark.parametrize("in_one", [False, True])
def test_nor_does_one_window_say_that_anything_follows_a_quantity(in_one: bool) -> None:
    state = search(told(40.0, FLEXIBLE, in_one=in_one), GATES, KNOWN)
    assert (ILL, ITEMS[FLEXIBLE].key) in said(state)
    follows = verdict.following(Weighed(state), ILL, 0.0, GATES)
    assert bool(follows) is not in_one


def test_what_a_window_gives_adds_up_to_what_a_column_takes_off() -> None:
    state = told(9.0, 0, in_one=False)
    change = given(state, ILL, [0], np.array([9.0]))
    robot = state.robots[ILL]
    errors = robot.own_errors
    left = errors - 9.0 * np.sum(robot.by_run(0), axis=0)
    assert change.sum() == pytest.approx(errors @ errors - left @ left)
    less = without_loudest(state, ILL, change).robots[ILL]
    loudest = int(np.argmax(change))
    assert less.by_window(less.own_errors**2)[loudest] == 0.0
    assert less.information[0, 0] < robot.information[0, 0]


def test_the_loudest_window_of_a_swarm_is_one_robots() -> None:
    state = with_kept(told(40.0, 0, in_one=True), ILL, [])
    change = given(state, SWARM, [0], np.array([9.0]))
    less = without_loudest(state, SWARM, change)
    changed = [one is not other for one, other in zip(less.robots, state.robots, strict=True)]
    assert changed == [k == ILL for k in range(ROBOTS)]


def test_a_window_that_stands_for_many_moments_is_not_one_that_happened_once() -> None:
    """Such as the level of a sensor's noise in half of the log."""
    blocks = [np.array([0, 0, 1]), np.array([-1, 2])]
    state: Any = SimpleNamespace(
        robots=[SimpleNamespace(block=one) for one in blocks], members=lambda _: [0, 1]
    )
    change = np.array([1.0, 2.0, 3.0, 9.0, 4.0])
    assert of_a_moment(state, SWARM, change).tolist() == [1.0, 2.0, 3.0, 0.0, 4.0]

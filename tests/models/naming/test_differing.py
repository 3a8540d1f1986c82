"""Robots of one log that differ by more than health, all of them: found, and no robot's fault."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.differing import differing
from realitygap.models.naming.engine.search import search
from realitygap.models.naming.engine.state import State
from tests.models.naming.test_naming_search import GATES, KNOWN, columns, health_of, log, said

ROBOTS = 10
SPREAD = 8.0


def differing_log(seed: int, *, ill: float = 0.0, robots: int = ROBOTS) -> State:
    """Robots that all have some of the first column; one has more of the third."""
    random = np.random.default_rng(np.random.SeedSequence([7, seed]))
    sizes: FloatArray = random.normal(0.0, SPREAD, robots)
    has = {(k, 0): float(size) for k, size in enumerate(sizes)}
    if ill:
        has[3, 2] = ill
    return log(columns(seed, robots), has, seed=seed, health=health_of(0.5, 0.5))


def test_what_most_robots_have_is_a_difference_between_robots_and_its_size_is_found() -> None:
    found = [differing(differing_log(seed)).between for seed in range(20)]
    assert {name for one in found for name in one} == {"a.p0"}
    sizes = [one["a.p0"] for one in found if one]
    assert len(sizes) >= 18
    assert np.median(sizes) == pytest.approx(SPREAD, rel=0.3)


def test_nobody_is_accused_of_it_and_an_ill_robot_beside_it_still_is() -> None:
    unasked = said(search(differing_log(1), GATES, KNOWN))
    assert {key for _, key in unasked} >= {"a"}
    state = differing(differing_log(1, ill=12.0))
    assert said(search(state, GATES, KNOWN)) == {(3, "c")}


def test_one_or_two_ill_robots_are_no_difference_between_all() -> None:
    has = {(2, 0): 30.0, (5, 0): -25.0}
    state = log(columns(4, ROBOTS), has, health=health_of(0.5, 0.5))
    assert differing(state).between == {}
    assert said(search(differing(state), GATES, KNOWN)) == {(2, "a"), (5, "a")}


@pytest.mark.parametrize("size", [30.0, 300.0, 3000.0])
@pytest.mark.parametrize("ill", [(4,), (1, 4, 6, 9)])
def test_however_ill_some_are_the_others_do_not_differ(ill: tuple[int, ...], size: float) -> None:
    """Those who are ill move what all have in common, away from the sound ones."""
    log_of_ill = log(columns(6, ROBOTS), {(k, 0): size for k in ill}, health=health_of(0.5, 0.5))
    state = differing(log_of_ill)
    assert state.between == {}
    assert said(search(state, GATES, KNOWN)) == {(k, "a") for k in ill}


def test_sound_robots_differ_by_nothing_more() -> None:
    healthy = [log(columns(k, ROBOTS), {}, seed=k, health=health_of(0.5, 0.5)) for k in range(30)]
    assert all(differing(state).between == {} for state in healthy)


def test_two_robots_do_not_tell_which_of_them_is_odd() -> None:
    state = differing_log(2, robots=2)
    assert differing(state) is state

"""From scores to names: what is offered, chosen, replaced and kept, in robots that are linear."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming import verdict
from realitygap.models.naming.channels.motion.identify import _healthy
from realitygap.models.naming.engine.fitter import Fitter
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.engine.marginal import Scored
from realitygap.models.naming.engine.search import _replacing, contenders, offers, search
from realitygap.models.naming.engine.seen import away, least_seen
from realitygap.models.naming.engine.state import SWARM, Kept, State
from realitygap.models.naming.engine.threshold import bracket
from realitygap.models.naming.engine.weighed import Weighed
from realitygap.models.naming.findings import Follows, Named
from realitygap.models.naming.rules import Rules
from realitygap.models.naming.verdict import inseparable
from tests.models.linear import cause, flexible, item, name_of, sound, state_of

A, B, C = cause("a"), cause("b"), cause("c")
GATES, RULES = Gates(), Rules()
ROWS, ROBOTS = 250, 6
ITEMS = (item(A, 0), item(B, 1), item(C, 2), flexible("heading", 3), flexible("place", 4))
ALWAYS = 5
KNOWN = np.ones(ALWAYS + 1, dtype=bool)


def columns(seed: int, robots: int = ROBOTS) -> FloatArray:
    """(robots, ROWS, 6) columns of length 1; the last is a channel's steady change."""
    x = np.random.default_rng(seed).normal(size=(robots, ROWS, ALWAYS + 1))
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def log(
    x: FloatArray,
    has: dict[tuple[int, int], float],
    *,
    seed: int = 0,
    health: Health | None = None,
    items: tuple[Item, ...] = ITEMS,
) -> State:
    """A log in which robots have so much of some columns, by robot and column."""
    y = np.random.default_rng(seed).normal(size=x.shape[:2])
    for (robot, column), size in has.items():
        y[robot] += size * x[robot, :, column]
    return state_of(y, x, items, health)


def said(state: State) -> set[tuple[int, str]]:
    return {(scope, one.item.key) for scope, kept in state.kept.items() for one in kept}


def health_of(sd: float, swarm: float) -> Health:
    names = [name_of(one, k) for one in ITEMS for k in range(len(one.columns))]
    return sound(names, [sd] * len(names), [swarm] * len(names))


def all_have(column: int, size: float, robots: int = ROBOTS) -> dict[tuple[int, int], float]:
    return {(k, column): size for k in range(robots)}


def score(information: FloatArray, slope: list[float]) -> Scored:
    return Scored(np.asarray(information), np.array(slope), 1e3)


def test_what_is_offered_is_what_a_linear_step_takes_off_best_first() -> None:
    found = offers(score(np.diag([4.0, 1.0]), [8.0, 5.0]), ITEMS[:2], KNOWN, RULES)
    assert [(one.item.key, one.gain) for one in found] == [("b", 25.0), ("a", 16.0)]
    assert found[1].step == pytest.approx([2.0])


def test_a_further_parameter_costs_its_price() -> None:
    two = cause("two", 2)
    (found,) = offers(score(np.eye(2), [3.0, 4.0]), (item(two, 0, 1),), KNOWN, RULES)
    assert found.gain == pytest.approx(25.0 - RULES.price)
    assert RULES.price > 2.0, "what a parameter without a meaning takes off by chance, twice"


@pytest.mark.parametrize(("sign", "offered"), [(0, True), (1, False), (-1, True)])
def test_a_cause_on_the_wrong_side_of_its_null_is_not_offered(sign: int, offered: bool) -> None:
    one = item(cause("one", sign=sign), 0)
    assert bool(offers(score(np.eye(1), [-9.0]), (one,), KNOWN, RULES)) is offered


@pytest.mark.parametrize(("share", "offered"), [(0.31, True), (0.29, False)])
def test_a_small_share_of_a_whole_dose_is_no_such_cause(share: float, offered: bool) -> None:
    one = item(A, 0, dose=0.5)
    assert bool(offers(score(100.0 * np.eye(1), [100.0 * share]), (one,), KNOWN, RULES)) is offered


def test_a_threshold_has_no_half_doses() -> None:
    """Half of a whole dose would take off 25; the whole of it takes off and adds as much."""
    steady, jumps = (item(cause("t", smooth=s), 0, dose=0.5) for s in (True, False))
    half = score(100.0 * np.eye(1), [50.0])
    assert offers(half, (steady,), KNOWN, RULES)[0].gain == pytest.approx(25.0)
    assert offers(half, (jumps,), KNOWN, RULES)[0].gain == pytest.approx(0.0)


def test_what_nobody_measured_or_nothing_tells_is_not_offered() -> None:
    told = score(np.diag([1.0, 0.0]), [9.0, 9.0])
    assert [one.item.key for one in offers(told, ITEMS[:2], KNOWN, RULES)] == ["a"]
    assert offers(told, ITEMS[:2], ~KNOWN, RULES) == []


def test_what_robots_share_is_known_as_a_sum_with_how_the_log_was_recorded() -> None:
    """All may be late, or the log: one robot that is later still is fitted as well as offered."""
    x = columns(9)
    x[:, :, ALWAYS] = x[:, :, 0]
    state = log(x, {(3, 0): 9.0}, health=health_of(0.5, 20.0))
    state = replace(state, unsure={"free@5": 20.0})
    weighed = Weighed(state)
    (promised,) = (one for one in offers(weighed.score(3), ITEMS[:1], KNOWN, RULES))
    fitter = Fitter(weighed, 3)
    gained = fitter.square([], []) - fitter.square([A], [promised.step])
    assert promised.gain > GATES.cause
    assert gained == pytest.approx(promised.gain, rel=1e-3)
    assert said(search(state, GATES, KNOWN)) == {(3, "a")}


def test_a_fit_of_some_causes_finds_of_healthy_robots_what_those_can_show_of_their_mean() -> None:
    """Healthy robots have some of two causes that cancel; a fit of one alone sees what is left."""
    x = columns(10)
    x[:, :, 1] = -0.9 * x[:, :, 0]
    state = log(
        x, {}, health=replace(health_of(0.5, 0.5), mean=np.array([9.0, 8.0, 0.0, 0.0, 0.0]))
    )
    alone, both = (_healthy(Weighed(state), [0, 2], terms) for terms in ([A], [A, C]))
    assert alone[0] == pytest.approx([9.0 - 0.9 * 8.0])
    assert [each.shape for each in both] == [(1,), (1,)]
    assert both[0] == pytest.approx(alone[0], abs=1e-6)
    assert both[1] == pytest.approx([0.0], abs=1e-6)


def test_contenders_are_causes_that_promise_enough() -> None:
    items = (*ITEMS[:3], item(A, 5, dose=1.0), ITEMS[3])
    told = score(np.eye(6), [10.0, 6.0, 5.0, 20.0, 0.0, 9.0])
    listed = contenders(offers(told, items, KNOWN, RULES), RULES)
    assert [one.item.key for one in listed] == ["a", "b"]
    assert listed[0].item.dose is None


def test_a_hidden_fault_is_named_with_its_robot_and_size() -> None:
    found = search(log(columns(1), {(2, 0): 9.0}), GATES, KNOWN)
    assert said(found) == {(2, "a")}
    assert found.of(2)[0].coordinates == pytest.approx([9.0], abs=3.0)
    assert found.robots[2].motion[0][0] == "a"


def test_two_faults_of_one_robot_are_both_named() -> None:
    assert said(search(log(columns(2), {(0, 0): 12.0, (0, 2): -10.0}), GATES, KNOWN)) == {
        (0, "a"),
        (0, "c"),
    }


def test_in_a_hundred_healthy_logs_nothing_is_named() -> None:
    """Robots differ by twice what a log errs by, and swarms by as much as it errs."""
    random, health = np.random.default_rng(3), health_of(2.0, 1.0)
    for seed in range(100):
        x = columns(seed, 4)
        own = random.normal(size=5) + 2.0 * random.normal(size=(4, 5))
        has = {(k, c): own[k, c] for k in range(4) for c in range(5)}
        assert not said(search(log(x, has, seed=seed, health=health), GATES, KNOWN))


@pytest.mark.parametrize(("sd", "named"), [(0.5, True), (4.0, False)])
def test_a_fault_is_named_where_robots_differ_by_less(sd: float, named: bool) -> None:
    found = search(log(columns(4), {(2, 0): 9.0}, health=health_of(sd, 0.0)), GATES, KNOWN)
    assert bool(said(found)) is named


def test_what_all_robots_have_is_the_swarms_and_what_one_has_its_own() -> None:
    x, health = columns(5), health_of(0.5, 0.2)
    assert said(search(log(x, all_have(0, 8.0), health=health), GATES, KNOWN)) == {(SWARM, "a")}
    assert said(search(log(x, {(1, 0): 12.0}, health=health), GATES, KNOWN)) == {(1, "a")}
    both = all_have(0, 8.0) | {(4, 1): 12.0}
    assert said(search(log(x, both, health=health), GATES, KNOWN)) == {(SWARM, "a"), (4, "b")}


@pytest.mark.parametrize(("spread", "named"), [(0.2, True), (20.0, False)])
def test_what_swarms_differ_in_is_no_fault_of_one(spread: float, named: bool) -> None:
    state = log(columns(5), all_have(0, 8.0), health=health_of(0.5, spread))
    assert bool(said(search(state, GATES, KNOWN))) is named


def test_of_two_robots_neither_is_a_swarm() -> None:
    found = search(log(columns(6, 2), all_have(0, 12.0, 2)), GATES, KNOWN)
    assert said(found) == {(0, "a"), (1, "a")}


def test_what_leaves_more_than_a_fifth_worse_off_is_not_the_swarms() -> None:
    most = {key: size for key, size in all_have(0, 12.0).items() if key[0] < 4}
    assert said(search(log(columns(7), most), GATES, KNOWN)) == {(k, "a") for k in range(4)}


def resembling(seed: int, alike: float) -> FloatArray:
    """Columns in which what follows the place goes with cause a."""
    x = columns(seed)
    x[:, :, 4] = alike * x[:, :, 0] + np.sqrt(1.0 - alike**2) * x[:, :, 4]
    return x


PLAIN = (*ITEMS[:4], flexible("place", 4, always=ALWAYS))


def test_a_cause_is_preferred_to_what_merely_resembles_it() -> None:
    found = search(log(resembling(8, 0.95), {(1, 0): 25.0}, items=PLAIN), GATES, KNOWN)
    assert said(found) == {(1, "a")}


def test_what_follows_a_quantity_is_preferred_to_a_cause_that_merely_resembles_it() -> None:
    found = search(log(resembling(8, 0.9), {(1, 4): 25.0}, items=PLAIN), GATES, KNOWN)
    assert said(found) == {(1, "speed/place")}


def test_a_cause_that_still_tells_much_beside_what_follows_something_is_not_replaced() -> None:
    """Here both are true: the cause is named first, what follows something beside it."""
    x = resembling(9, 0.6)
    found = search(log(x, {(1, 0): 15.0, (1, 4): 20.0}, items=PLAIN), GATES, KNOWN)
    assert said(found) == {(1, "a"), (1, "speed/place")}


@pytest.mark.parametrize(
    ("feigns", "alike", "plain", "own", "replaced"),
    [
        ({}, 0.96, 20.0, 0.0, True),
        ({"b": 1.0}, 0.96, 20.0, 0.0, False),
        ({"b": 1.0}, 0.9, 20.0, 0.0, True),
        ({}, 0.3, 20.0, 12.0, False),
        ({}, 0.9, 2.0, 18.0, False),
    ],
)
def test_a_cause_is_replaced_by_what_does_clearly_better_and_leaves_it_little(
    feigns: dict[str, float], alike: float, plain: float, own: float, replaced: bool
) -> None:
    """Of a rough cause clearly better is more, and no cause leaves what it still tells itself."""
    x = np.eye(3)
    x[:, 1] = [alike, np.sqrt(1.0 - alike**2), 0.0]
    y = plain * x[:, 1] + own * x[:, 0]
    told = Scored(x.T @ x, x.T @ y, float(y @ y))
    items = (item(cause("a", feigns=feigns), 0), flexible("place", 1, always=2))
    one, other = sorted(offers(told, items, KNOWN, RULES), key=lambda offer: offer.item.key)
    found = _replacing(told, one, one.gain, [other], np.zeros(len(told.slope)), RULES)
    assert (found.key if found else None) == ("speed/place" if replaced else None)


def test_what_follows_a_quantity_may_have_a_mean_that_a_cause_would_take_for_its_own() -> None:
    """A cause that is a channel's steady change, and a truth that varies about one."""
    x = columns(10)
    x[:, :, 0] = 0.99 * x[:, :, ALWAYS] + np.sqrt(1 - 0.99**2) * x[:, :, 0]
    found = search(log(x, {(1, 4): 20.0, (1, ALWAYS): 20.0}, items=PLAIN), GATES, KNOWN)
    assert (1, "speed/place") in said(found)


def test_a_cause_is_fitted_beside_what_follows_something() -> None:
    x = resembling(20, 0.8)
    state = log(x, {(1, 0): 15.0, (1, 4): 20.0}, items=PLAIN)
    state.kept[1] = (Kept(PLAIN[4], np.zeros(0)),)
    fit = Fitter(Weighed(state), 1).fit((A,), [np.zeros(1)])
    assert fit is not None
    robot = state.robots[1]
    design = robot.columns[:, [0, 4]]
    both = np.linalg.inv(design.T @ design)
    assert fit.coordinates[0] == pytest.approx((both @ design.T @ robot.y)[:1], rel=1e-6)
    assert fit.covariance == pytest.approx(both[:1, :1], rel=1e-6)


@pytest.mark.parametrize("windows", [6, 24, 1000])
def test_chance_passes_the_gates_of_few_windows_as_seldom_as_those_of_many(windows: int) -> None:
    """A deviance is measured in a noise that so many windows tell."""
    random = np.random.default_rng(21)
    plain = Gates(cause=4.0, flexible=6.0)
    told = plain.of(windows)
    noise = random.chisquare(windows - 1, 100_000) / (windows - 1)
    gain = random.normal(size=100_000) ** 2 / noise
    assert (gain > told.cause).mean() == pytest.approx(stats.chi2.sf(4.0, 1), abs=0.003)
    assert (gain > told.flexible).mean() == pytest.approx(stats.chi2.sf(6.0, 1), abs=0.003)


def test_a_threshold_lies_between_the_commanded_speeds_that_fit() -> None:
    """All values between two neighbouring speeds are the same to a log."""
    speeds = np.array([1.0, 2.0, 3.0, 5.0, 6.0])
    commands = np.column_stack([speeds, -speeds])
    gap = {1.5: 90.0, 2.5: RULES.odds - 0.1, 4.0: 0.0, 5.5: RULES.odds + 0.1, 0.5: 99.0}
    found = bracket(commands, 4.2, gap.__getitem__, RULES.odds)
    assert (found.best, found.low, found.high) == (4.0, 2.0, 5.0)
    weight = np.exp(-2.0 * np.array([RULES.odds - 0.1, 0.0, RULES.odds + 0.1]) / RULES.odds)
    inner = np.average([2.5, 4.0, 5.5], weights=weight * [1.0, 2.0, 1.0])
    assert found.mean == pytest.approx(inner, rel=1e-6)


def test_a_threshold_below_the_slowest_command_begins_at_nought() -> None:
    found = bracket(np.array([[1.0, 2.0]]), 0.4, lambda at: 100.0 * (at > 1.0), RULES.odds)
    assert (found.low, found.high) == (0.0, 1.0)


def test_a_fault_of_the_least_size_seen_passes_the_gate_in_95_of_100_logs() -> None:
    random, health, passed = np.random.default_rng(11), health_of(1.5, 0.7), 0
    draws = 400
    x = columns(11, 3)
    (size,) = least_seen(Weighed(log(x, {}, health=health)), GATES, KNOWN)["a"][1]
    for seed in range(draws):
        own = 0.7 * random.normal(size=5) + 1.5 * random.normal(size=(3, 5))
        has = {(k, c): own[k, c] for k in range(3) for c in range(5)}
        has[1, 0] += size
        found = Weighed(log(x, has, seed=seed, health=health)).score(1)
        passed += found.slope[0] ** 2 / found.information[0, 0] > GATES.cause
    assert passed / draws == pytest.approx(0.95, abs=0.03)


def test_of_whole_doses_the_least_that_is_sure_is_seen_and_of_limits_the_highest() -> None:
    limit = cause("limit", null=np.inf)
    items = (
        item(A, 0, dose=0.5),
        item(A, 1, dose=1.5),
        item(A, 2, dose=2.5),
        item(limit, 3, dose=4.0),
        item(limit, 4, dose=5.0),
        item(limit, 5, dose=6.0),
    )
    x = columns(12, 1) * np.array([1.0, 20.0, 30.0, 30.0, 20.0, 1.0])
    found = least_seen(Weighed(log(x, {}, items=items)), GATES, KNOWN)
    assert found["a"][0] == pytest.approx([1.5])
    assert found["limit"][0] == pytest.approx([5.0])


def test_what_healthy_robots_do_not_tell_is_not_seen() -> None:
    known = KNOWN.copy()
    known[0] = False
    assert set(least_seen(Weighed(log(columns(12), {})), GATES, known)) == {"b", "c"}


def test_how_far_from_health_a_robot_is_in_what_follows_something() -> None:
    far = away(Weighed(log(columns(13), {(2, 3): 12.0}, health=health_of(1.0, 0.0))))
    assert far["speed/heading"][2] == pytest.approx(12.0 / np.sqrt(2.0), abs=3.0)
    assert far["speed/heading"][[0, 1, 3, 4, 5]].max() < 3.5
    assert far["speed/place"].max() < 3.5


def circles(turning: FloatArray) -> tuple[State, Term]:
    """One robot in five runs: cause a asks for one more of b per turn to the left, and b may
    differ from run to run. `turning` (rows,) is what tells them apart."""
    a = cause("a", confusable_with=("b",))
    run = np.repeat(np.arange(5), ROWS // 5)
    x = np.zeros((1, ROWS, ALWAYS + 1))
    x[0, :, 1] = 1.0
    x[0, :, 0] = np.where(run % 2, 1.0, -1.0) + turning
    state = log(x, {(0, 0): 9.0}, items=(item(a, 0), *ITEMS[1:]))
    start = np.append(np.flatnonzero(np.diff(run, prepend=-1)), ROWS)
    for tracks in (state.tracks, state.robots[0].tracks):
        object.__setattr__(tracks, "start", start)
        object.__setattr__(tracks, "segment_robot", np.zeros(5, dtype=np.int64))
    return state, a


@pytest.mark.parametrize(("varies", "untold"), [(0.05, True), (1.0, False)])
def test_circles_do_not_tell_two_causes_that_may_differ_from_run_to_run(
    varies: float, untold: bool
) -> None:
    state, a = circles(varies * np.random.default_rng(14).normal(size=ROWS))
    fitter = Fitter(Weighed(state), 0)
    fit = fitter.fit((a,), [np.zeros(1)])
    assert fit is not None
    assert inseparable(fitter, (a,), fit, a) == ((B,) if untold else ())
    assert inseparable(fitter, (B,), fit, B) == ()


def judged(state: State, scope: int) -> Any:
    return verdict.judge(state, scope, GATES)[1]


def test_a_cause_is_worth_what_is_lost_without_it() -> None:
    state = search(log(columns(15), {(0, 0): 12.0, (0, 2): 10.0}), GATES, KNOWN)
    found = judged(state, 0)
    robot = state.robots[0]
    least = np.array([one.coordinates[0] for one in state.of(0)])
    assert [t.cause.name for t in found.terms] == ["a", "c"]
    for k, (column, gain) in enumerate(zip((0, 2), found.gains, strict=True)):
        other = robot.columns[:, [2, 0][k]]
        left = robot.y - other * (other @ robot.y) / (other @ other)
        own = robot.columns[:, column] - other * (other @ robot.columns[:, column])
        assert gain == pytest.approx((own @ left) ** 2 / (own @ own), rel=1e-3)
    assert least == pytest.approx(np.concatenate(found.fit.coordinates), abs=0.5)


@pytest.mark.parametrize(("family", "stays"), [("", True), ("starts", False)])
def test_a_weak_cause_beside_a_strong_one_of_its_family_is_what_that_leaves(
    family: str, stays: bool
) -> None:
    strong, weak = cause("strong", family=family), cause("weak", family=family)
    items = (item(strong, 0), item(weak, 1), *ITEMS[2:])
    state = log(columns(16), {(0, 0): 60.0, (0, 1): 10.0}, items=items)
    found = judged(search(state, GATES, KNOWN), 0)
    assert ("weak" in [t.cause.name for t in found.terms]) is stays


def test_the_held_out_share_is_that_of_doses_fitted_to_other_blocks() -> None:
    state = log(columns(17), {(0, 0): 20.0})
    fitter = Fitter(Weighed(state), 0)
    fit = fitter.fit((A,), [np.zeros(1)])
    assert fit is not None
    robot = state.robots[0]
    x, y = robot.columns[:, 0], robot.y
    fold = np.repeat(robot.tracks.block % 5, len(y) // len(robot.tracks.first))
    taken = 0.0
    for k in range(5):
        out = fold == k
        dose = x[~out] @ y[~out] / (x[~out] @ x[~out])
        taken += float((y[out] ** 2 - (y[out] - dose * x[out]) ** 2).sum())
    assert fitter.held_out((A,), fit.coordinates, 0) == pytest.approx(taken / (y @ y), rel=1e-6)


def test_what_rough_causes_feign_of_another_is_believed_of_their_robot_alone() -> None:
    """Beside the rough cause the other must be far larger to be named."""
    rough = cause("rough", feigns={"b": 10.0})
    items = (item(rough, 0), *ITEMS[1:])
    has = {(0, 0): 40.0, (0, 1): 12.0, (3, 1): 12.0}
    health = sound([name_of(one, 0) for one in items], [0.1] * 5, [0.0] * 5)
    found = search(log(columns(18), has, items=items, health=health), GATES, KNOWN)
    assert said(found) == {(0, "rough"), (3, "b")}


def named(gain: float, *robots: int) -> Named:
    one: Any = SimpleNamespace(robots=robots, evidence=SimpleNamespace(gain=gain))
    return one  # type: ignore[no-any-return]


def unknown(gain: float, *robots: int) -> Follows:
    return Follows(
        channel="speed",
        quantity="heading",
        robots=robots,
        whole_swarm=len(robots) > 1,
        distance=9.0,
        gain=gain,
        share=0.1,
    )


def test_a_name_much_weaker_than_something_unknown_in_its_robot_is_none() -> None:
    strong, weak, elsewhere = named(60.0, 1), named(40.0, 1), named(40.0, 2)
    found = verdict.standing([strong, weak, elsewhere], [unknown(100.0, 1)], RULES)
    assert found == [strong, elsewhere]
    assert verdict.standing([strong, weak], [unknown(200.0, 0, 1, 2)], RULES) == []


def test_what_follows_something_is_worth_what_it_takes_off_beside_the_causes() -> None:
    state = search(log(columns(19), {(0, 0): 20.0, (0, 3): 12.0}), GATES, KNOWN)
    (one,) = verdict.following(Weighed(state), 0, 400.0, GATES)
    assert (one.quantity, one.robots, one.whole_swarm) == ("heading", (0,), False)
    assert one.gain == pytest.approx(144.0, rel=0.4)
    assert verdict.following(Weighed(state), 0, 1e4, GATES) == []
    strict = Gates(flexible=300.0)
    assert verdict.following(Weighed(state), 0, 400.0, strict) == []


def test_an_interval_holds_the_part_though_a_robot_differs_in_it_as_sound_robots_do() -> None:
    sd = 3.0
    health = sound([name_of(one, 0) for one in ITEMS], [sd] * len(ITEMS), [0.0] * len(ITEMS))
    state = log(columns(17), {(0, 0): 40.0}, health=health)
    fit = Fitter(Weighed(state), 0).fit((A,), [np.zeros(1)])
    assert fit is not None
    x = state.robots[0].columns[:, 0]
    assert fit.covariance[0, 0] > sd**2 + 0.9 / float(x @ x)

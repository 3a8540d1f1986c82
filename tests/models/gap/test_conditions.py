import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive
from realitygap.models.gap.conditions import NEAR_ROBOT, NEAR_WALL, clear, nearest_robot
from realitygap.models.log.measured import make_log
from tests.models.small import driven_log

DRIVE = Drive()


def two_rates(apart):
    """A robot seen at 25 Hz and, `apart` m from it, five robots seen at 10 Hz."""
    fast = driven_log(1, robots=1, rows=500, step=0.04).assign(robot=9)
    slow = driven_log(2, robots=5, rows=200, step=0.1)
    fast["x"] += apart
    return make_log(pd.concat([fast, slow]), drive=DRIVE)


def expected(log):
    """Nearest other robot, row by row, each other one on the line between its poses around."""
    t, robot, place = log.t, log.frame["robot"].to_numpy(), log.poses[:, :2]
    nearest = np.full(len(t), np.inf)
    for other in np.unique(robot):
        own = robot == other
        there = np.column_stack([np.interp(t, t[own], place[own, k]) for k in range(2)])
        away = np.hypot(*(there - place).T)
        near = ~own & (t <= t[own][-1] + log.step)
        nearest[near] = np.minimum(nearest[near], away[near])
    return np.where(nearest < 1.0, nearest, np.inf)


def test_no_robot_is_its_own_nearest_robot_where_rows_come_at_different_rates():
    log = two_rates(50.0)
    assert np.isinf(nearest_robot(log)[log.frame["robot"] == 9]).all()


def test_the_nearest_other_robot_is_found_where_rows_come_at_different_rates():
    log = two_rates(0.0)
    found = nearest_robot(log)
    assert np.isfinite(found).mean() > 0.3
    np.testing.assert_allclose(found, expected(log))


def test_the_nearest_other_robot_is_found_though_every_stamp_is_a_little_off():
    frame = driven_log(3, robots=3, rows=1500)
    rng = np.random.default_rng(np.random.SeedSequence(4))
    even, late = make_log(frame, drive=DRIVE), frame.copy()
    late["t"] += np.clip(rng.normal(0.0, 0.005, len(late)), -0.015, 0.015)
    found = nearest_robot(make_log(late, drive=DRIVE))
    usual = nearest_robot(even)
    seen = np.isfinite(usual) & np.isfinite(found)
    assert seen.mean() > 0.3
    # a robot moves at most so far in 30 ms
    assert np.abs(found[seen] - usual[seen]).max() < 2.0 * 6.0 * 0.0205 * 0.03


@pytest.mark.parametrize("robots", [2, 5])
def test_at_one_rate_it_is_the_distance_at_that_moment(robots):
    log = make_log(driven_log(3, robots=robots, rows=300), drive=DRIVE)
    found, right = nearest_robot(log), expected(log)
    assert np.allclose(found, right)


def test_only_what_is_away_from_walls_and_robots_is_clear_of_contact():
    near, far = -1e-3, 1e-3
    table = pd.DataFrame(
        {
            "near_robot": NEAR_ROBOT + np.array([far, near, far, near]),
            "near_wall": NEAR_WALL + np.array([far, far, near, near]),
        }
    )
    assert clear(table).tolist() == [True, False, False, False]
    assert clear(table.drop(columns="near_wall")).tolist() == [True, False, True, False]

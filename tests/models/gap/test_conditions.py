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
    """Nearest other robot within a tick, row by row and robot by robot."""
    tick = np.round((log.t - log.t.min()) / log.step)
    robot, place = log.frame["robot"].to_numpy(), log.poses[:, :2]
    nearest = np.full(len(tick), np.inf)
    for k in range(len(tick)):
        other = place[(tick == tick[k]) & (robot != robot[k])]
        if len(other):
            nearest[k] = np.hypot(*(other - place[k]).T).min()
    return nearest


def test_no_robot_is_its_own_nearest_robot_where_rows_come_at_different_rates():
    log = two_rates(50.0)
    assert np.isinf(nearest_robot(log)[log.frame["robot"] == 9]).all()


def test_the_nearest_other_robot_is_found_where_rows_come_at_different_rates():
    log = two_rates(0.0)
    found, right = nearest_robot(log), expected(log)
    seen = np.isfinite(found)
    assert seen.mean() > 0.3
    # of several rows in one tick the first counts: a robot moves at most so far within a tick
    assert np.abs(found[seen] - right[seen]).max() < 6.0 * 0.0205 * log.step


@pytest.mark.parametrize("robots", [2, 5])
def test_at_one_rate_it_is_the_distance_at_that_moment(robots):
    log = make_log(driven_log(3, robots=robots, rows=300), drive=DRIVE)
    found, right = nearest_robot(log), expected(log)
    assert np.allclose(found, np.where(right < 1.0, right, np.inf))


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

"""What sound robots teach of how robots differ, from simulated ones whose differences are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.health import Health, Told, farthest, few, healthy
from realitygap.models.naming.engine.marginal import integrated
from realitygap.models.naming.rules import Rules
from tests.models.linear import sound

NAMES = ("a.p", "b.p", "speed/heading", "bend/heading")
MEAN = np.array([0.4, -0.2, 0.1, 0.0])
SD = np.array([0.5, 0.3, 0.4, 0.2])
SWARM_SD = np.array([0.3, 0.1, 0.2, 0.1])
RULES = Rules()
SWARMS, ROBOTS = 60, 10


def told(
    seed: int, related: float, *, swarms: int = SWARMS, robots: int = ROBOTS, error: float = 1.0
) -> list[Told]:
    """Logs that tell a coefficient to `error` of its spread, of causes that hang together."""
    random = np.random.default_rng(seed)
    covariance = np.diag(SD**2)
    covariance[0, 1] = covariance[1, 0] = related * SD[0] * SD[1]
    found = []
    for _ in range(swarms):
        common = MEAN + SWARM_SD * random.normal(size=4)
        info, slope = [], []
        for _ in range(robots):
            x = random.normal(size=(200, 4)) / (np.sqrt(200.0) * error * SD)
            own = common + random.multivariate_normal(np.zeros(4), covariance)
            info.append(x.T @ x)
            slope.append(x.T @ (x @ own + random.normal(size=200)))
        found.append(Told(NAMES, np.array(info), np.array(slope)))
    return found


def correlation(found: Health) -> FloatArray:
    sd = np.sqrt(np.diag(found.covariance))
    return np.asarray(found.covariance / sd[:, None] / sd)


def test_robots_differ_by_what_is_left_beyond_what_their_logs_err_by() -> None:
    """Errors are as large as what is looked for. Of 600 robots in each of eight references a
    standard deviation is known to a fortieth: twice that."""
    each = [healthy(told(seed, 0.6)) for seed in range(8)]
    mean = np.mean([one.mean for one in each], axis=0)
    error = np.hypot(SWARM_SD / np.sqrt(8 * SWARMS), SD / np.sqrt(8 * SWARMS * ROBOTS))
    assert (np.abs(mean - MEAN) < 3.0 * error).all()
    sd = np.mean([np.sqrt(np.diag(one.covariance)) for one in each], axis=0)
    assert sd == pytest.approx(SD, rel=0.05)
    swarm = np.mean([np.sqrt(one.swarm) for one in each], axis=0)
    assert swarm == pytest.approx(SWARM_SD, rel=0.2), "three of sixty are believed to be alike"
    assert (each[0].robots, each[0].swarms) == (SWARMS * ROBOTS, SWARMS)


@pytest.mark.parametrize("far", [10.0, 100.0])
def test_what_every_swarm_does_is_no_difference_between_swarms(far: float) -> None:
    """Four swarms that are far from the reference's motion, all by as much."""
    moved = far * SD
    swarms = [
        Told(one.names, one.information, one.slope + one.information @ moved)
        for one in told(5, 0.0, swarms=4)
    ]
    found = healthy(swarms)
    assert found.mean == pytest.approx(MEAN + moved, rel=0.3)
    assert (np.sqrt(found.swarm) < np.hypot(SWARM_SD, 0.2 * moved)).all()


def test_causes_vary_jointly_and_what_follows_something_by_itself() -> None:
    found = correlation(healthy(told(2, 0.6)))
    assert found[0, 1] == pytest.approx(0.6, abs=0.15)
    assert found[2:, :] == pytest.approx(np.eye(4)[2:])
    few_robots = correlation(healthy(told(2, 0.9, swarms=1, robots=10, error=0.05)))
    assert 0.2 < few_robots[0, 1] < 0.6, "ten robots' weight of no correlation"


def test_one_wobble_that_two_causes_can_see_is_counted_once() -> None:
    """Were each cause given its own, a robot of twice the wobble would be twice as excusable."""
    found = healthy(told(3, 1.0, error=0.3))
    assert correlation(found)[0, 1] > 0.9
    prior, _ = found.on(NAMES, RULES)
    both = np.array([SD[0], SD[1], 0.0, 0.0])
    unlike = np.array([SD[0], -SD[1], 0.0, 0.0])
    info = np.diag(1e4 / SD**2)
    prior = prior._replace(mean=np.zeros(4))
    same, opposite = (
        integrated(info, info @ u, float(u @ info @ u), prior).square for u in (both, unlike)
    )
    assert same == pytest.approx(1.0, rel=0.3)
    assert opposite > 10.0 * same


@pytest.mark.parametrize("count", [2, 5, 50])
def test_chance_passes_few_robots_spread_as_seldom_as_that_of_many(count: int) -> None:
    assert stats.t.sf(few(count, 5.0) * 5.0, count - 1) == pytest.approx(stats.norm.sf(5.0))


def test_many_robots_spread_is_taken_as_it_is() -> None:
    assert few(10**7, 5.0) == pytest.approx(1.0, abs=1e-4)
    assert few(6, 5.0) > few(20, 5.0) > few(200, 5.0) > 1.0


def test_a_prior_is_of_what_was_measured_in_whatever_order_a_log_has_it() -> None:
    known = healthy(told(6, 0.6, swarms=5, robots=4))
    prior, spread = known.on(("bend/heading", "new.p", "b.p", "a.p"), RULES)
    assert prior.at.tolist() == [0, 2, 3]
    assert prior.mean == pytest.approx(known.mean[[3, 1, 0]])
    own = known.covariance[np.ix_([3, 1, 0], [3, 1, 0])]
    assert prior.root @ prior.root.T == pytest.approx(
        few(20 + RULES.believed, RULES.few_sure) ** 2 * own
    )
    assert spread[1] == 0.0
    assert spread[3] > np.sqrt(known.swarm[0])


def test_the_farthest_healthy_robot_is_as_far_as_it_is() -> None:
    """One robot lies five standard deviations off in one cause, one four in what follows."""
    info = np.array([np.diag(1e6 / SD**2)] * 5)
    away = np.zeros((5, 4))
    away[1, 1], away[4, 2] = 5.0 * SD[1], -4.0 * SD[2]
    swarm = Told(NAMES, info, np.einsum("rkl,rl->rk", info, away))
    cause, flexible = farthest(sound(NAMES, SD, np.zeros(4)), [swarm])
    assert cause == pytest.approx(25.0, rel=1e-3)
    assert flexible == pytest.approx(16.0, rel=1e-3)

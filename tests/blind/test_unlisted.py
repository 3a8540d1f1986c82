"""What no catalogue lists is physical too: it changes what its words say, by about its bar."""

from __future__ import annotations

import math

import numpy as np
import pytest

from realitygap.reality import constants as k
from realitygap.reality.effects import catalogue, parse_effects
from realitygap.reality.world import World
from realitygap.studies.blind.trials import Hidden, blind_config, plan
from realitygap.studies.blind.unlisted import UNLISTED
from realitygap.studies.hidden.menu import STRANGE

SPEED = 6.0 * k.WHEEL_RADIUS


def world(specs: str, poses: list[list[float]]) -> World:
    effects = parse_effects(specs.split(), len(poses), UNLISTED)
    found = World(len(poses), np.random.SeedSequence(1), effects=effects, poses=np.array(poses))
    found.light.set_scenario(2)
    return found


def straight(specs: str, poses: list[list[float]], seconds: float = 1.0) -> np.ndarray:
    """(robots, 2) of way ahead (m) and turn (rad) of robots told to go straight."""
    here = world(specs, poses)
    for _ in range(round(seconds / k.CONTROL_STEP)):
        here.sense()
        here.act(np.full((len(poses), 2), 6.0))
    here.sense()
    here.close()
    moved = here.poses - np.array(poses)
    return np.stack([np.hypot(moved[:, 0], moved[:, 1]), moved[:, 2]], axis=1)


def test_nothing_unlisted_is_listed_and_each_has_its_entry() -> None:
    assert not set(UNLISTED) & set(catalogue())
    assert set(UNLISTED) == set(STRANGE)
    random = np.random.default_rng(1)
    for name, entry in STRANGE.items():
        hidden = Hidden(name, dict(entry.values(entry.bar, random)), (), entry.bar, 1.0)
        assert parse_effects((hidden.spec,), 3, UNLISTED)[0].effect is UNLISTED[name]


def test_a_battery_draws_them_by_turns_above_their_bars() -> None:
    trials = plan(blind_config(trials=64, effects=("motor_lag",)))
    strange = [t.hidden[0] for t in trials if t.kind == "unlisted"]
    assert [one.name for one in strange[:7]] == list(STRANGE)
    assert min(one.multiple for one in strange) >= 1.5


def test_an_eccentric_wheel_turns_the_robot_there_and_back() -> None:
    half = straight("eccentric_wheel:share=0.1,wheel=right", [[-0.4, 0.0, 0.0]], math.pi / 6.0)
    whole = straight("eccentric_wheel:share=0.1,wheel=left", [[-0.4, 0.0, 0.0]], math.pi / 3.0)
    assert abs(half[0, 1]) < 0.03
    assert abs(whole[0, 1]) < 0.03
    quarter = straight("eccentric_wheel:share=0.1,wheel=right", [[-0.4, 0.0, 0.0]], 0.28)
    assert quarter[0, 1] == pytest.approx(0.1 * k.WHEEL_RADIUS / k.AXLE, rel=0.25)


def test_wheels_are_slower_on_the_carpet_alone() -> None:
    ahead = straight("carpet:share=0.1", [[-0.4, 0.2, 0.0], [-0.4, -0.2, 0.0]])[:, 0]
    assert ahead[0] / ahead[1] == pytest.approx(0.9, abs=0.01)


def test_shy_robots_are_slower_near_one_another_alone() -> None:
    near = [[-0.4, 0.2, 0.0], [-0.4, 0.28, 0.0], [-0.4, -0.3, 0.0]]
    ahead = straight("shy_robots:share=0.1", near)[:, 0]
    gap = 0.08 - 2.0 * k.BODY_RADIUS
    assert ahead[:2] / ahead[2] == pytest.approx([1.0 - 0.1 * math.exp(-gap / 0.05)] * 2, abs=0.01)


def test_fast_wheels_lose_more_than_slow_ones() -> None:
    ahead = straight("speed_loss:share=0.1,robot=1", [[-0.4, 0.2, 0.0], [-0.4, -0.2, 0.0]])[:, 0]
    assert ahead[1] / ahead[0] == pytest.approx(1.0 - 0.1 * 6.0 / k.WHEEL_SPEED_MAX, abs=0.01)


def test_two_that_change_wheels_act_one_upon_the_other() -> None:
    poses = [[-0.4, 0.2, 0.0], [-0.4, -0.2, 0.0]]
    free = straight("carpet:share=0.0", poses)[:, 0]
    both = straight("speed_loss:share=0.1,robot=0 carpet:share=0.2", poses)[:, 0]
    share = both / free
    assert share == pytest.approx([0.8 * (1.0 - 0.1 * 6.0 / k.WHEEL_SPEED_MAX), 1.0], abs=0.01)


def test_a_lens_pulls_far_robots_inwards() -> None:
    here = world("lens:share=0.1", [[0.5, 0.0, 0.0], [0.0, 0.1, 0.0]])
    here.sense()
    here.close()
    assert here.tracker.poses[0, 0] == pytest.approx(0.5 * (1.0 - 0.1 * (0.5 / 0.6) ** 2), abs=2e-3)
    assert here.tracker.poses[1, 1] == pytest.approx(0.1, abs=3e-3)


def test_a_low_sun_is_read_by_the_sensors_that_face_it() -> None:
    here = world("low_sun:counts=100,direction=0.0", [[0.0, 0.0, 0.0]])
    here.sense()
    here.close()
    assert here.infrared.counts[0, 0] == pytest.approx(100.0 * math.cos(0.297), abs=10.0)
    assert here.infrared.counts[0, 3] < 10.0


def test_a_flickering_lamp_swings_about_its_power() -> None:
    here = world("flicker:share=0.5,period=4.0", [[0.2, 0.0, 0.0]])
    lit = np.empty(100)
    for step in range(100):
        here.sense()
        lit[step] = k.LIGHT_DARK - k.LIGHT_AMBIENT - here.light.counts[0, 0]
        here.time_step += 1
    here.close()
    assert lit[20:30].mean() / lit[70:80].mean() == pytest.approx(1.5 / 0.5, rel=0.2)

"""A wider arena is the nominal one, further out: wall, nest, lamps, food."""

from __future__ import annotations

import math

import numpy as np
import pytest

from realitygap.embedded_sim import SENSOR_ANGLES
from realitygap.reality import constants as k
from realitygap.reality.arena import ForagingArena
from realitygap.reality.engine import EngineName
from realitygap.reality.hardware import Hardware
from realitygap.reality.rays import RAYS, ClosedRays, RaysName
from realitygap.reality.senses import Infrared, Light, Tracker
from realitygap.reality.world import World, scatter

WIDE = ForagingArena(1.5)
OPPOSITE, AT_NEST = 0, 2


def test_the_nominal_arena_is_the_papers() -> None:
    usual = ForagingArena()
    assert (usual.radius, usual.nest, usual.food_items) == (0.6, k.NEST, k.FOOD_ITEMS)
    assert usual.lamps == ((-0.6, 0.0), None, (0.6, 0.0))


def test_a_wider_one_has_its_nest_and_lamps_as_near_to_the_wall_and_food_as_dense() -> None:
    assert pytest.approx((1.4, 0.0, 0.2)) == WIDE.nest
    assert WIDE.lamps == ((-1.5, 0.0), None, (1.5, 0.0))
    assert WIDE.food_items == round(7 * 1.5**2 / 0.36)


def test_food_lies_all_over_it_and_not_in_its_nest() -> None:
    tracker = Tracker(Hardware.nominal(1, WIDE), np.random.default_rng(0))
    random = np.random.default_rng(1)
    places = []
    for item in range(4 * WIDE.food_items):
        tracker.place_food(item % WIDE.food_items, random)
        places.append(tracker.food[item % WIDE.food_items].copy())
    far = np.hypot(*np.array(places).T)
    assert 0.97 * (WIDE.radius - k.BODY_RADIUS) < far.max() <= WIDE.radius - k.BODY_RADIUS
    assert np.hypot(*(np.array(places) - WIDE.nest[:2]).T).min() >= k.NEST[2]
    tracker.poses[:] = *tracker.food[-1], 0.0
    tracker.locate(np.zeros(1, dtype=np.uint8))
    assert tracker.on_food[0]  # the last of them is offered as well


def test_a_robot_sees_the_lamp_where_it_stands() -> None:
    light = Light(Hardware.nominal(1, WIDE), np.random.default_rng(0))
    brightest = {}
    for scenario in (OPPOSITE, AT_NEST):
        light.set_scenario(scenario)
        beside = -1.3 if scenario == OPPOSITE else 1.3
        light.sense(np.array([[beside, 0.0, 0.0]]))
        brightest[scenario] = SENSOR_ANGLES[int(light.counts[0].argmin())]
    assert abs(brightest[AT_NEST]) < math.pi / 4 < 3 * math.pi / 4 < abs(brightest[OPPOSITE])


@pytest.mark.parametrize("rays", RAYS)
def test_robots_drive_to_its_wall_and_see_it_there(engine: EngineName, rays: RaysName) -> None:
    start = np.array([[WIDE.radius - 0.1, 0.0, 0.0], [0.0, -WIDE.radius + 0.1, -0.5 * np.pi]])
    seed = np.random.SeedSequence(1)
    world = World(2, seed, poses=start, engine=engine, rays=rays, arena=WIDE)
    for _ in range(50):
        world.sense()
        world.act(np.full((2, 2), 6.0))
    world.sense()
    reached = np.hypot(world.poses[:, 0], world.poses[:, 1])
    seen = world.infrared.counts.max(axis=1)
    world.close()
    assert reached == pytest.approx(WIDE.radius - k.BODY_RADIUS, abs=3e-3)
    assert (seen > 1000.0).all()


def test_two_hundred_robots_find_room_where_they_are_as_dense_as_ten_usually() -> None:
    wide = ForagingArena(k.ARENA_RADIUS * math.sqrt(20.0))
    poses = scatter(200, np.random.default_rng(3), wide.radius)
    far = np.hypot(poses[:, 0], poses[:, 1])
    assert far.max() < wide.radius - k.BODY_RADIUS
    assert (far < wide.radius / 2).mean() == pytest.approx(0.25, abs=0.07)


def test_rays_are_cast_however_many_robots_stand_in_one_place() -> None:
    """More than the list of neighbours holds: then all are asked."""
    crowd, pair = np.zeros((90, 3)), np.zeros((2, 3))
    crowd[0] = pair[0] = 0.1, 0.0, np.pi
    seen = []
    for poses in (crowd, pair):
        infrared = Infrared(Hardware.nominal(len(poses)), np.random.default_rng(0))
        infrared.sense(ClosedRays(poses, None), poses)
        seen.append(infrared._fraction[infrared._owner.tolist().index(0)])
    assert 0.0 < seen[0] == seen[1] < 1.0

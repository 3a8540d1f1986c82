"""Infrared, light, tracker and radio against their own laws."""

from __future__ import annotations

import math

import numpy as np
import pytest

from realitygap.embedded_sim import SENSOR_ANGLES
from realitygap.reality import constants as k
from realitygap.reality.engine import Engine, EngineName, engine_class
from realitygap.reality.hardware import Hardware
from realitygap.reality.rays import ClosedRays, Rays
from realitygap.reality.senses import Infrared, Light, Radio, Tracker

AMPLITUDE = [counts * k.IR_OFFSET**2 for counts in k.IR_CONTACT_COUNTS]
OPPOSITE, NO_LIGHT, AT_NEST = 0, 1, 2
RIM = k.BODY_RADIUS + 1e-4
FRONT_MEDIAN = 0.985
"""Of the law: two thirds of the 20 % of outliers are low, so the median sits a tenth of an s.d.
(14 %) low."""


def median_counts(world: Rays, poses: np.ndarray, repeats: int = 3000) -> np.ndarray:
    infrared = Infrared(Hardware.nominal(len(poses)), np.random.default_rng(0))
    readings = np.empty((repeats, len(poses), 8))
    for i in range(repeats):
        infrared.sense(world, poses)
        readings[i] = infrared.counts
    return np.median(readings, axis=0)


@pytest.mark.parametrize("distance", [0.01, 0.02, 0.04, 0.08])
@pytest.mark.parametrize("incidence_deg", [0.0, 30.0, 60.0])
def test_infrared_before_a_flat_wall_is_the_inverse_square_law_with_incidence(
    distance: float, incidence_deg: float
) -> None:
    incidence = math.radians(incidence_deg)
    wall = ClosedRays(np.zeros((0, 3)), k.ARENA_RADIUS, np.array([[1.0, 0.0]]))
    yaw = incidence - SENSOR_ANGLES[7]
    x = k.ARENA_RADIUS - (distance + RIM) * math.cos(incidence)
    pose = np.array([[x, -(distance + RIM) * math.sin(incidence), yaw]])
    counts = median_counts(wall, pose)[0, 7]
    law = AMPLITUDE[7] * math.cos(incidence) / (distance + k.IR_OFFSET) ** 2
    assert counts == pytest.approx(FRONT_MEDIAN * min(law, k.COUNTS_MAX), rel=0.015, abs=0.8)


@pytest.mark.parametrize("sensor", range(8))
def test_infrared_before_the_curved_wall_is_the_law_at_the_rays_length(
    engine: EngineName, sensor: int
) -> None:
    x, y, yaw = 0.53, 0.05, 0.4
    world = engine_class(engine)()
    world.add_ring()
    world.add_epuck([x, y, yaw])
    counts = median_counts(world, np.array([[x, y, yaw]]))[0, sensor]
    world.close()
    angle = yaw + SENSOR_ANGLES[sensor]
    u = np.array([math.cos(angle), math.sin(angle)])
    p = np.array([x, y]) + RIM * u
    along = p @ u
    root = math.sqrt(along**2 + k.ARENA_RADIUS**2 - p @ p)
    distance, cosine = root - along, root / k.ARENA_RADIUS
    law = AMPLITUDE[sensor] * cosine / (distance + k.IR_OFFSET) ** 2
    law *= FRONT_MEDIAN if sensor in (0, 7) else 1.0
    assert counts == pytest.approx(law if distance < k.IR_RANGE else 0.0, rel=0.03, abs=1.0)


def test_robots_see_each_other(engine: EngineName) -> None:
    world = engine_class(engine)()
    gap = 0.03
    poses = np.array([[0.0, 0.0, -SENSOR_ANGLES[0]], [2 * k.BODY_RADIUS + gap, 0.0, 0.0]])
    for pose in poses:
        world.add_epuck(pose)
    counts = median_counts(world, poses)
    world.close()
    law = AMPLITUDE[0] / (gap - 1e-4 + k.IR_OFFSET) ** 2
    assert counts[0, 0] == pytest.approx(law, rel=0.05)
    assert counts[0, 4] == pytest.approx(0.0, abs=2.0)  # looks the other way


def test_rays_left_out_by_the_broad_phase_would_have_hit_nothing(engine: EngineName) -> None:
    """Every sensor that the full set of rays sees, the chosen rays see, and alike."""
    random = np.random.default_rng(7)
    robots = 10
    infrared = Infrared(Hardware.nominal(robots), np.random.default_rng(0))
    for _ in range(60):
        poses = np.column_stack(
            [random.uniform(-0.42, 0.42, (robots, 2)), random.uniform(-np.pi, np.pi, robots)]
        )
        world = crowd(engine, poses)
        infrared.sense(world, poses)
        chosen = infrared._owner[: np.count_nonzero(infrared._end[:, 2])]
        fraction, normals = np.zeros(8 * robots), np.zeros((8 * robots, 2))
        world.cast(*rays(poses), fraction, normals)
        world.close()
        assert set(np.flatnonzero(fraction < 1.0)) <= set(chosen.tolist())
        infrared._end[:] = 0.0


def crowd(engine: EngineName, poses: np.ndarray) -> Engine:
    """The arena with robots at poses, which may overlap."""
    world = engine_class(engine)()
    world.add_ring()
    for pose in poses:
        world.add_epuck(pose)
    return world


def rays(poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(8 robots, 3) m: where the sensors' rays begin and end."""
    angles = poses[:, 2:] + np.array(SENSOR_ANGLES)
    u = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=2).reshape(-1, 3)
    start = np.repeat(np.column_stack([poses[:, :2], 0 * angles[:, 0] + k.SENSOR_HEIGHT]), 8, 0)
    return start + RIM * u, start + (RIM + k.IR_RANGE) * u


def test_infrared_noise_has_the_measured_share_of_gross_outliers(engine: EngineName) -> None:
    world = engine_class(engine)()
    world.add_ring()
    pose = np.array([[k.ARENA_RADIUS - RIM - 0.03, 0.0, -SENSOR_ANGLES[0]]])
    world.add_epuck(pose[0])
    infrared = Infrared(Hardware.nominal(1), np.random.default_rng(1))
    counts = np.empty(6000)
    for i in range(len(counts)):
        infrared.sense(world, pose)
        counts[i] = infrared.counts[0, 0]
    world.close()
    law = AMPLITUDE[0] / (0.03 + k.IR_OFFSET) ** 2
    gross = np.abs(counts / law - 1.0) > 0.5
    assert 0.16 < gross.mean() < 0.24
    assert (counts < 8).mean() == pytest.approx(0.2 / 3, abs=0.012)
    spread = 1.4826 * np.median(np.abs(counts[~gross] / law - np.median(counts[~gross] / law)))
    assert spread == pytest.approx(k.IR_NOISE, rel=0.12)


def light_counts(poses: np.ndarray, scenario: int, repeats: int = 100) -> np.ndarray:
    light = Light(Hardware.nominal(len(poses)), np.random.default_rng(0))
    light.set_scenario(scenario)
    readings = np.empty((repeats, len(poses), 8))
    for i in range(repeats):
        light.sense(poses)
        readings[i] = light.counts
    return readings.mean(axis=0)


@pytest.mark.parametrize("scenario", [OPPOSITE, AT_NEST])
def test_light_is_the_inverse_square_law_with_a_cosine_aperture(scenario: int) -> None:
    poses = np.array([[0.1, 0.2, 0.7]])
    lamp = np.array([k.LAMP_RADIUS if scenario == AT_NEST else -k.LAMP_RADIUS, 0.0, k.LAMP_HEIGHT])
    counts = light_counts(poses, scenario)[0]
    for sensor, angle in enumerate(SENSOR_ANGLES):
        u = np.array([math.cos(0.7 + angle), math.sin(0.7 + angle), 0.0])
        way = lamp - np.array([0.1, 0.2, k.SENSOR_HEIGHT]) - k.BODY_RADIUS * u
        irradiance = k.LAMP_POWER * max(way @ u, 0.0) / (way @ way) ** 1.5
        assert counts[sensor] == pytest.approx(k.LIGHT_DARK - k.LIGHT_AMBIENT - irradiance, abs=2.0)


def test_without_a_lamp_all_sensors_read_the_room() -> None:
    assert light_counts(np.zeros((1, 3)), NO_LIGHT) == pytest.approx(
        k.LIGHT_DARK - k.LIGHT_AMBIENT, abs=2.0
    )


def test_contrast_fades_between_06_and_1_m_from_the_lamp() -> None:
    def contrast(distance: float) -> float:
        counts = light_counts(
            np.array([[k.LAMP_RADIUS - distance, 0.0, -SENSOR_ANGLES[0]]]), AT_NEST
        )
        return float(np.ptp(counts))

    assert contrast(0.6) > 40.0 > contrast(1.0)


def test_a_robot_in_the_way_casts_a_shadow_and_one_beside_it_does_not() -> None:
    facing = [0.2, 0.0, -SENSOR_ANGLES[0]]
    lit = light_counts(np.array([facing]), AT_NEST)[0, 0]
    shaded = light_counts(np.array([facing, [0.3, 0.0, 0.0]]), AT_NEST)[0, 0]
    beside = light_counts(np.array([facing, [0.3, 0.1, 0.0]]), AT_NEST)[0, 0]
    behind = light_counts(np.array([facing, [0.1, 0.0, 0.0]]), AT_NEST)[0, 0]
    assert shaded == pytest.approx(k.LIGHT_DARK - k.LIGHT_AMBIENT, abs=2.0)
    assert beside == pytest.approx(lit, abs=2.0)
    assert behind == pytest.approx(lit, abs=2.0)


def test_light_passes_over_a_robot_that_stands_far_enough_from_the_sensor() -> None:
    """The line rises from the sensor to the lamp; past a share of the way it clears a body."""
    facing = [-0.5, 0.0, -SENSOR_ANGLES[0]]
    sensor = -0.5 + k.BODY_RADIUS
    clear = (k.BODY_TOP - k.SENSOR_HEIGHT) / (k.LAMP_HEIGHT - k.SENSOR_HEIGHT)
    edge = sensor + clear * (k.LAMP_RADIUS - sensor)
    dark = k.LIGHT_DARK - k.LIGHT_AMBIENT
    for x, shadow in ((edge - 0.01, True), (edge + 2 * k.BODY_RADIUS, False)):
        counts = light_counts(np.array([facing, [x, 0.0, 0.0]]), AT_NEST)[0, 0]
        assert (dark - counts < 5.0) == shadow


def test_the_tracker_errs_as_a_vicon_does() -> None:
    tracker = Tracker(Hardware.nominal(4), np.random.default_rng(0))
    poses = np.array([[0.1 * i, 0.0, 0.5] for i in range(4)])
    errors = np.empty((3000, 4, 3))
    for i in range(len(errors)):
        tracker.measure(poses)
        errors[i] = tracker.poses - poses
    assert errors.std(axis=(0, 1)) == pytest.approx(
        [k.TRACKER_NOISE, k.TRACKER_NOISE, k.TRACKER_YAW_NOISE], rel=0.03
    )
    assert np.abs(errors.mean(axis=(0, 1))).max() < 2e-4


def test_food_lies_where_robots_can_reach_it_and_never_in_the_nest() -> None:
    tracker = Tracker(Hardware.nominal(1), np.random.default_rng(0))
    random = np.random.default_rng(1)
    places = np.empty((5000, 2))
    for i in range(len(places)):
        tracker.place_food(i % k.FOOD_ITEMS, random)
        places[i] = tracker.food[i % k.FOOD_ITEMS]
    reach = k.ARENA_RADIUS - k.BODY_RADIUS
    assert np.hypot(places[:, 0], places[:, 1]).max() <= reach
    assert np.hypot(places[:, 0] - k.NEST[0], places[:, 1]).min() >= k.NEST[2]
    # uniform in area: the half of the disc away from the nest holds its share of the free area
    left = (places[:, 0] < 0.0).mean()
    grid = np.mgrid[-reach:reach:800j, -reach:reach:800j]
    free = (np.hypot(*grid) <= reach) & (np.hypot(grid[0] - k.NEST[0], grid[1]) >= k.NEST[2])
    assert left == pytest.approx((free & (grid[0] < 0)).sum() / free.sum(), abs=0.02)


def test_the_virtual_sensor_says_food_and_nest_and_offers_an_item_once() -> None:
    tracker = Tracker(Hardware.nominal(3), np.random.default_rng(0))
    tracker.food[:] = [[0.0, 0.0]] + [[-0.3, 0.3]] * (k.FOOD_ITEMS - 1)
    tracker.poses[:] = [[0.01, 0.0, 0.0], [0.02, 0.0, 0.0], [0.5, 0.0, 0.0]]
    tracker.locate(np.zeros(3, dtype=np.uint8))
    assert tracker.on_food.tolist() == [1, 0, 0]
    assert tracker.on_nest.tolist() == [0, 0, 1]
    assert tracker.item.tolist() == [0, -1, -1]
    tracker.locate(np.array([1, 0, 0], dtype=np.uint8))  # the first carries one already
    assert tracker.on_food.tolist() == [1, 1, 0]


def test_radio_reaches_20_cm_and_stops_at_a_third_robot() -> None:
    radio = Radio(4)
    active = np.ones(4, dtype=np.uint8)
    poses = np.array([[0.0, 0, 0], [0.19, 0, 0], [0.0, 0.21, 0], [-0.19, 0.0, 0]])
    radio.exchange(poses, active)
    assert radio.heard.tolist() == [[0, 1, 0, 1], [1, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]]
    assert radio.messages == 4
    radio.exchange(np.array([[0.0, 0, 0], [0.19, 0, 0], [0.095, 0.01, 0], [5.0, 0, 0]]), active)
    assert radio.heard[0, 1] == 0  # robot 2 stands between
    radio.exchange(poses, np.array([1, 0, 1, 1], dtype=np.uint8))
    assert radio.heard[0, 1] == 0  # not switched on

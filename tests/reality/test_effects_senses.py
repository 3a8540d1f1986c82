"""Every effect on infrared, light and nest changes what is sensed as its physics says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from realitygap.embedded_sim import SENSOR_ANGLES
from realitygap.reality import constants as k
from tests.reality.hidden import drive, readings, straight, world_of

NO_LIGHT, AT_NEST = 1, 2
BEFORE_WALL = np.array([[0.54, 0.0, 0.0], [-0.54, 0.0, math.pi]])
"""Both look straight at the wall, their fronts 25 mm from it."""
BEFORE_EACH_OTHER = np.array([[-0.045, 0.0, 0.0], [0.045, 0.0, math.pi]])
IN_THE_OPEN = np.array([[0.0, 0.3, 0.0], [0.0, -0.3, 0.0]])
"""Nothing within reach of the infrared; the lamp at the nest ahead and to the side."""
FRONT = [0, 7]

pytestmark = pytest.mark.usefixtures("engine")


def signal(*specs: str, scenario: int = AT_NEST, poses: np.ndarray = IN_THE_OPEN) -> np.ndarray:
    """(2, 8) mean counts below full scale."""
    return k.LIGHT_DARK - readings(*specs, poses=poses, scenario=scenario).ls.mean(axis=0)


def lamp_light(pose: np.ndarray, x: float = k.LAMP_RADIUS, y: float = 0.0,
               height: float = k.LAMP_HEIGHT, exponent: float = 2.0) -> np.ndarray:  # fmt: skip
    """(8,) counts that the nominal lamp's power gives at a pose, by the law."""
    angles = pose[2] + np.array(SENSOR_ANGLES)
    dx = x - pose[0] - k.BODY_RADIUS * np.cos(angles)
    dy = y - pose[1] - k.BODY_RADIUS * np.sin(angles)
    distance = np.sqrt(dx**2 + dy**2 + (height - k.SENSOR_HEIGHT) ** 2)
    facing = np.maximum(dx * np.cos(angles) + dy * np.sin(angles), 0.0)
    return k.LAMP_POWER * facing / distance ** (1.0 + exponent)


def test_infrared_gain_scales_the_readings_of_its_sensor() -> None:
    ps = np.median(readings("ir_gain:scale=0.5,sensor=7,robot=1", poses=BEFORE_WALL).ps, axis=0)
    assert ps[1, 7] / ps[0, 7] == pytest.approx(0.5, rel=0.05)
    assert ps[1, 0] / ps[0, 0] == pytest.approx(1.0, rel=0.05)


def test_infrared_gain_scales_all_sensors_unless_one_is_named() -> None:
    ps = np.median(readings("ir_gain:scale=0.5,robot=1", poses=BEFORE_WALL).ps, axis=0)
    assert ps[1, FRONT] / ps[0, FRONT] == pytest.approx([0.5, 0.5], rel=0.05)


def test_a_darker_wall_dims_what_the_wall_returns() -> None:
    nominal = np.median(readings(poses=BEFORE_WALL).ps, axis=0)
    darker = np.median(readings("wall_albedo:scale=0.6", poses=BEFORE_WALL).ps, axis=0)
    assert darker[:, FRONT] / nominal[:, FRONT] == pytest.approx(np.full((2, 2), 0.6), rel=0.05)


def test_a_darker_wall_does_not_dim_what_a_robot_returns() -> None:
    nominal = readings(poses=BEFORE_EACH_OTHER, repeats=50).ps
    darker = readings("wall_albedo:scale=0.6", poses=BEFORE_EACH_OTHER, repeats=50).ps
    assert np.median(nominal[:, :, FRONT]) > 100.0
    assert (darker == nominal).all()


def test_a_dead_infrared_sensor_reads_zero() -> None:
    ps = readings("ir_dead_sensor:sensor=7,robot=1", poses=BEFORE_WALL).ps
    assert (ps[:, 1, 7] == 0.0).all()
    assert (ps[:, 0, 7] > 0.0).mean() > 0.8


def test_a_turned_ring_reads_what_a_turned_robot_would() -> None:
    angle = 0.2
    poses = BEFORE_WALL.copy()
    poses[0, 2] += angle
    read = readings(f"ir_rotation:angle={angle},robot=1", poses=poses, scenario=AT_NEST)
    turned = readings(poses=BEFORE_WALL + np.array([0.0, 0.0, angle]), scenario=AT_NEST)
    assert np.median(read.ps[:, 1], axis=0) == pytest.approx(
        np.median(turned.ps[:, 1], axis=0), rel=0.05, abs=3.0
    )
    assert read.ls[:, 1].mean(axis=0) == pytest.approx(turned.ls[:, 1].mean(axis=0), abs=1.5)
    motion = drive(straight, 0.4, "ir_rotation:angle=0.2,robot=1")
    assert (motion.true == drive(straight, 0.4).true).all()


def test_ambient_infrared_adds_counts_wherever_the_robot_is() -> None:
    spec = "ir_offset:counts=50,robot=1"
    ps = readings(spec, poses=IN_THE_OPEN).ps.mean(axis=0)
    assert ps[1] - 50.0 == pytest.approx(np.zeros(8), abs=0.5)
    ps = np.median(readings(spec, poses=BEFORE_WALL, repeats=2000).ps, axis=0)
    assert ps[1, FRONT] - ps[0, FRONT] == pytest.approx([50.0, 50.0], rel=0.25)


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_infrared_noise_is_scaled_around_the_same_reading(scale: float) -> None:
    spec = f"ir_noise:scale={scale},robot=1"
    ps = readings(spec, poses=BEFORE_WALL, repeats=2000).ps[:, :, FRONT]
    middle = np.median(ps, axis=0)
    spread = np.median(np.abs(ps - middle), axis=0)
    assert middle[1] / middle[0] == pytest.approx([1.0, 1.0], rel=0.06)
    assert (spread[1] / spread[0]).mean() == pytest.approx(scale, rel=0.3)
    still = readings("ir_noise:scale=0,robot=1", poses=IN_THE_OPEN, repeats=20).ps
    assert (still[:, 1] == 0.0).all()


def test_a_brighter_lamp_scales_its_light_and_not_the_rooms() -> None:
    extra = signal("lamp_intensity:scale=1.5") - signal()
    expected = np.array([0.5 * lamp_light(pose) for pose in IN_THE_OPEN])
    assert extra == pytest.approx(expected, abs=1.5)
    assert expected.max() > 20.0


def test_no_lamp_effect_shows_where_no_lamp_is_lit() -> None:
    specs = ("lamp_intensity:scale=3", "lamp_height:height=0.3", "lamp_decay:rate=0.02",
             "light_falloff:exponent=3", "lamp_moved:x=0.2")  # fmt: skip
    assert (signal(*specs, scenario=NO_LIGHT) == signal(scenario=NO_LIGHT)).all()


@pytest.mark.parametrize(
    ("spec", "law"),
    [
        ("lamp_height:height=0.25", {"height": 0.25}),
        ("light_falloff:exponent=2.5", {"exponent": 2.5}),
        ("lamp_moved:x=-0.1,y=0.2", {"x": k.LAMP_RADIUS - 0.1, "y": 0.2}),
    ],
)
def test_the_lamps_field_follows_its_law(spec: str, law: dict[str, float]) -> None:
    expected = np.array([lamp_light(pose, **law) for pose in IN_THE_OPEN])
    nominal = np.array([lamp_light(pose) for pose in IN_THE_OPEN])
    assert np.abs(expected - nominal).max() > 5.0
    assert signal(spec) - k.LIGHT_AMBIENT == pytest.approx(expected, abs=1.5)


def test_ambient_light_is_a_share_of_the_lamps_reading_at_half_a_metre() -> None:
    at_half = np.array([k.LAMP_RADIUS - 0.5, 0.0, -SENSOR_ANGLES[0]])
    expected = 0.3 * lamp_light(at_half)[0]
    extra = signal("ambient_light:level=0.3", scenario=NO_LIGHT) - signal(scenario=NO_LIGHT)
    assert extra == pytest.approx(np.full((2, 8), expected), abs=1.0)


@pytest.mark.parametrize("scenario", [NO_LIGHT, AT_NEST])
def test_a_second_lamp_adds_its_own_field_in_every_case(scenario: int) -> None:
    spec = "second_lamp:x=-0.3,y=0.7,intensity=0.8"
    extra = signal(spec, scenario=scenario) - signal(scenario=scenario)
    expected = np.array([0.8 * lamp_light(pose, -0.3, 0.7) for pose in IN_THE_OPEN])
    assert extra == pytest.approx(expected, abs=1.5)


def test_a_decaying_lamp_dims_linearly_with_time() -> None:
    rate, steps = 0.05, 400
    ls = readings(f"lamp_decay:rate={rate}", poses=IN_THE_OPEN, scenario=AT_NEST).ls
    light = k.LIGHT_DARK - k.LIGHT_AMBIENT - ls
    brightest = lamp_light(IN_THE_OPEN[0]).argmax()
    late = light[-100:, 0, brightest].mean() / light[:100, 0, brightest].mean()
    middle = (np.array([steps - 50, 50]) - 0.5) * k.CONTROL_STEP
    assert late == pytest.approx(np.divide(*(1.0 - rate * middle)), abs=0.02)


def test_a_curved_response_bends_the_counts_below_full_scale() -> None:
    exponent = 1.2
    bent, linear = signal(f"light_gamma:exponent={exponent},robot=1"), signal()
    expected = k.LIGHT_DARK * (linear[1] / k.LIGHT_DARK) ** exponent
    assert bent[1] == pytest.approx(expected, abs=1.5)
    assert bent[0] == pytest.approx(linear[0], abs=1.5)


def test_a_covered_light_sensor_reads_dark() -> None:
    dark = signal("ls_dead_sensor:sensor=3,robot=1")
    assert dark[1, 3] == pytest.approx(0.0, abs=5.0)
    assert dark[0, 3] > 40.0
    assert dark[1, 2] > 40.0


def on_nest(x: float, y: float, *specs: str) -> list[bool]:
    """What the virtual sensor says to two robots that follow one another to a place."""
    world = world_of(2, *specs, seed=3)
    world.tracker.poses[:] = x, y, 0.0
    world.tracker.locate(np.zeros(2, dtype=np.uint8))
    world.close()
    return [bool(flag) for flag in world.tracker.on_nest]


def test_a_moved_nest_is_sensed_where_it_is() -> None:
    x, y, radius = k.NEST
    spec = "nest_moved:x=-0.05,y=0.02,robot=1"
    for angle in np.linspace(0.0, 2.0 * math.pi, 7):
        for share, inside in ((0.97, True), (1.03, False)):
            at = (
                x - 0.05 + share * radius * math.cos(angle),
                y + 0.02 + share * radius * math.sin(angle),
            )
            assert on_nest(*at, spec)[1] is inside
    assert on_nest(x + 0.95 * radius, y, spec) == [True, False]


def test_a_larger_nest_is_sensed_within_its_radius() -> None:
    x, y, radius = k.NEST
    assert on_nest(x - 1.15 * radius, y, "nest_radius:scale=1.2,robot=1") == [False, True]
    assert on_nest(x - 1.25 * radius, y, "nest_radius:scale=1.2,robot=1") == [False, False]

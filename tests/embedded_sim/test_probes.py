"""The menu of manoeuvres: what robots do in them, and that they come home."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim import CONTROL_STEP, InputError, PointModel
from realitygap.embedded_sim.manoeuvres import NAMES
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.pilot import ARRIVED, PATIENCE, Pilot, fly
from realitygap.embedded_sim.probes import MENU, Lap, Probe, probe

MODEL = PointModel()
ROBOTS = 10
DISTURBED = 0.096
"""m between centres within which two e-pucks disturb one another."""


@pytest.mark.parametrize("name", MENU)
def test_robots_keep_clear_of_one_another_and_of_the_wall(name: str) -> None:
    poses, commands = fly(MENU[name], ROBOTS, MODEL, round(60.0 / CONTROL_STEP))
    apart = np.hypot(*(poses[:, :, None, :2] - poses[:, None, :, :2]).transpose(3, 0, 1, 2))
    assert apart[:, ~np.eye(ROBOTS, dtype=bool)].min() > DISTURBED
    reach = MODEL.arena_radius - MODEL.body_radius
    assert np.hypot(poses[..., 0], poses[..., 1]).max() < reach - 0.02
    assert np.abs(commands).max() < 2.0 * np.pi  # what an e-puck's wheels can do
    assert np.ptp(poses[..., 2], axis=0).max() > np.pi  # every heading comes round


@pytest.mark.parametrize("name", MENU)
def test_a_lap_ends_where_it_began(name: str) -> None:
    poses, _ = fly(MENU[name], 2, MODEL, round(100.0 / CONTROL_STEP))
    lap = MENU[name].lap(1, 2, MODEL)
    short = Probe(name="one", does="", lap=lambda number, robots, model: lap)
    flown, _ = fly(short, 2, MODEL, len(lap.wheels) + 1)
    if name not in ("steps", "alone"):  # whose turns do not come round
        np.testing.assert_allclose(flown[-1, :, :2], lap.homes[:, :2], atol=1e-9)
    assert np.isfinite(poses).all()


def _still(number: int, robots: int, model: PointModel) -> Lap:
    homes = np.tile([0.1, -0.05, 2.0], (robots, 1))
    return Lap(homes, np.zeros((1, robots, 2)))


@given(
    x=st.floats(-0.3, 0.3), y=st.floats(-0.3, 0.3), yaw=st.floats(-np.pi, np.pi, exclude_max=True)
)
@settings(max_examples=30, deadline=None)
def test_a_robot_comes_home_from_anywhere(x: float, y: float, yaw: float) -> None:
    pilot = Pilot(Probe(name="stay", does="", lap=_still), 1, MODEL)
    pose: FloatArray = np.array([[x, y, yaw]])
    radius, axle = np.array(MODEL.drive.wheel_radius), MODEL.drive.axle
    for _ in range(round(PATIENCE / CONTROL_STEP)):
        way = pilot.step(pose) * radius * CONTROL_STEP
        turn = (way[:, 1] - way[:, 0]) / axle
        heading = pose[:, 2] + 0.5 * turn
        ahead = way.mean(axis=1)
        pose = pose + np.column_stack([ahead * np.cos(heading), ahead * np.sin(heading), turn])
    assert np.hypot(pose[0, 0] - 0.1, pose[0, 1] + 0.05) < 2.0 * ARRIVED
    assert abs(np.angle(np.exp(1j * (pose[0, 2] - 2.0)))) < 0.1


def test_a_robot_that_is_not_seen_is_not_driven() -> None:
    pilot = Pilot(Probe(name="stay", does="", lap=_still), 2, MODEL)
    commands = pilot.step(np.array([[np.nan] * 3, [-0.2, 0.0, 0.0]]))
    assert not commands[0].any()
    assert commands[1].any()


def test_a_robot_that_does_not_come_home_does_not_hold_up_the_others() -> None:
    pilot = Pilot(MENU["steps"], 2, MODEL)
    stuck = np.zeros((2, 3))  # never at its home
    waited = 0
    while pilot.step(stuck)[0].tolist() != [6.0, 6.0]:
        waited += 1
    assert waited == round(PATIENCE / CONTROL_STEP) - 1


def test_alone_means_that_nobody_else_moves() -> None:
    lap = MENU["alone"].lap(3, 4, MODEL)
    assert lap.wheels[:, 1].any()
    assert not np.delete(lap.wheels, 1, axis=1).any()


def test_robots_face_one_another_then_the_wall() -> None:
    facing, outward = (MENU["face-to-face"].lap(n, 2, MODEL).homes for n in (0, 1))
    ahead = np.column_stack([np.cos(facing[:, 2]), np.sin(facing[:, 2])])
    between = facing[1, :2] - facing[0, :2]
    np.testing.assert_allclose(ahead[0], between / np.linalg.norm(between), atol=1e-12)
    np.testing.assert_allclose(ahead[1], -ahead[0], atol=1e-12)
    np.testing.assert_allclose(np.arctan2(*outward[:, 1::-1].T), outward[:, 2], atol=1e-12)


@pytest.mark.parametrize("name", MENU)
def test_a_swarm_that_finds_no_room_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=rf"--robots: got 90, expected at most .*probe:{name}"):
        MENU[name].lap(0, 90, MODEL)


def test_an_unknown_manoeuvre_names_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean slow-ramp"):
        probe("slowramp")


def test_the_names_that_are_listed_are_those_of_the_menu() -> None:
    assert tuple(MENU) == NAMES

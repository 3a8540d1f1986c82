"""Manoeuvres for robots of any size and speed, on the floor that there is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim import CONTROL_STEP, Drive, InputError, PointModel
from realitygap.embedded_sim.pilot import fly
from realitygap.embedded_sim.probes import FAST, MENU
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.log.measured import make_log
from realitygap.models.naming.proposal.ground import (
    DESIGNED_BODY,
    Ground,
    ground,
    resampled,
)
from realitygap.models.naming.proposal.menu import SECONDS, flight, flights
from realitygap.models.naming.proposal.propose import _no_help
from tests.models.naming.test_diagnosis import LAG, named
from tests.models.small import driven_log

ARENA = Ground(x=0.0, y=0.0, radius=0.6, walled=True, body_radius=0.035, fastest=6.28)
SIZES = st.floats(0.02, 2.0)


def of_size(size: float) -> PointModel:
    """An e-puck, larger or smaller as a whole."""
    drive = Drive(wheel_radius=(0.0205 * size, 0.0205 * size), axle=0.053 * size)
    return PointModel(drive=drive, body_radius=0.035 * size, arena_radius=0.6 * size)


def test_what_the_menu_was_made_for_is_the_epuck() -> None:
    robot = read_model_file("epuck").robot
    assert robot.body_radius == DESIGNED_BODY
    assert robot.wheel_speed_max >= FAST


@pytest.mark.parametrize("name", MENU)
def test_an_epuck_flies_the_menu_as_it_is(name: str) -> None:
    planned = fly(MENU[name], 3, PointModel(), round(SECONDS / CONTROL_STEP))
    found = flight(MENU[name], 3, PointModel(), ARENA)
    assert (found.poses == planned[0]).all()
    assert (found.commands == planned[1]).all()


@settings(max_examples=6)
@given(
    body=SIZES,
    wheel=st.floats(0.2, 1.2),
    axle=st.floats(0.8, 2.0),
    room=st.floats(4.0, 9.0),
    fastest=st.floats(1.0, 40.0),
    name=st.sampled_from(["spins", "steps", "straights"]),
)
def test_no_robot_is_sent_out_of_its_room_or_beyond_its_speed(
    body: float, wheel: float, axle: float, room: float, fastest: float, name: str
) -> None:
    drive = Drive(wheel_radius=(wheel * body, wheel * body), axle=axle * body)
    place = Ground(
        x=3.0, y=-1.0, radius=room * body, walled=False, body_radius=body, fastest=fastest
    )
    try:
        found = flight(MENU[name], 1, PointModel(drive=drive, body_radius=body), place)
    except InputError:
        assert room < 6.0 or wheel > 0.6  # less than the menu's reach, or quicker than an e-puck
        return
    out = np.hypot(found.poses[..., 0], found.poses[..., 1]).max() + body
    assert out <= place.radius
    assert np.abs(found.commands).max() <= fastest * (1.0 + 1e-9)
    # whole steps of the e-puck's time, each of which lasts 1 / pace as long here
    assert abs(len(found.poses) - SECONDS / CONTROL_STEP) <= 0.5 / place.pace + 0.5
    assert found.clear.all()  # there is no wall


@given(size=SIZES)
@settings(max_examples=5)
def test_a_robot_twice_as_large_goes_twice_as_far_by_the_same_commands(size: float) -> None:
    place = Ground(
        x=0.0, y=0.0, radius=0.6 * size, walled=True, body_radius=0.035 * size, fastest=6.28
    )
    found = flight(MENU["circle"], 2, of_size(size), place)
    small = flight(MENU["circle"], 2, PointModel(), ARENA)
    assert np.allclose(found.commands, small.commands, atol=1e-6)
    assert np.allclose(found.poses / [size, size, 1.0], small.poses, atol=1e-6)


@given(step=st.floats(0.005, 0.5), pace=st.floats(0.1, 1.0), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_wheels_turn_by_the_same_angles_at_any_rate(step: float, pace: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    commands = rng.uniform(-6.0, 6.0, (100, 2, 2))
    poses = np.cumsum(rng.normal(size=(100, 2, 3)), axis=0)
    where, found = resampled(poses, commands, every=step * pace, step=step)
    at = step * pace * len(found)
    whole = int(at / CONTROL_STEP + 1e-9)
    angle = commands[:whole].sum(axis=0) * CONTROL_STEP
    if whole < len(commands):
        angle = angle + commands[whole] * (at - whole * CONTROL_STEP)
    assert np.allclose(found.sum(axis=0) * step, angle, atol=1e-9)
    assert len(where) == len(found)
    assert (where[0] == poses[0]).all()


def test_in_the_open_there_is_as_much_room_as_the_log_shows() -> None:
    file = read_model_file("epuck").model_copy(update={"arena": None})
    frame = driven_log(3, robots=2, rows=800)
    frame["x"] += 10.0
    place = ground(file, make_log(frame, drive=Drive()))
    away = np.hypot(frame["x"] - place.x, frame["y"] - place.y)
    assert away.max() + 0.035 == pytest.approx(place.radius)
    assert not place.walled
    assert place.step == 0.04
    walled = ground(read_model_file("epuck"), make_log(frame, drive=Drive()))
    assert (walled.x, walled.y, walled.radius, walled.walled) == (0.0, 0.0, 0.6, True)


def test_what_means_nothing_for_these_robots_is_not_on_their_menu() -> None:
    open_ground = Ground(x=0, y=0, radius=0.6, walled=False, body_radius=0.035, fastest=6.28)
    cramped = Ground(x=0, y=0, radius=0.1, walled=False, body_radius=0.035, fastest=6.28)
    names = {one.probe.name for one in flights(1, PointModel(), open_ground)}
    assert names == set(MENU) - {"tour", "dark-tour", "face-to-face"}
    assert {one.probe.name for one in flights(1, PointModel(), ARENA)} == set(MENU) - {
        "face-to-face"
    }
    assert flights(1, PointModel(), cramped) == []


@pytest.mark.parametrize("robots", [1, 2, 3, 7, 13])
def test_a_formation_is_spread_as_far_as_there_is_room(robots: int) -> None:
    poses = flight(MENU["steps"], robots, PointModel(), ARENA).poses
    spread = ARENA.spread(poses)
    assert np.allclose(np.diff(spread, axis=0), np.diff(poses, axis=0))
    assert np.hypot(spread[..., 0], spread[..., 1]).max() + 0.035 < ARENA.radius
    for k in range(robots - 1):
        before, after = (
            np.hypot(*(one[0, k + 1 :, :2] - one[0, k, :2]).T).min() for one in (poses, spread)
        )
        assert after >= before - 1e-12
        assert robots > 7 or after > 0.25


def test_where_nothing_finds_room_it_is_said_how_much_there_is() -> None:
    place = Ground(x=0.0, y=0.0, radius=0.467, walled=False, body_radius=0.105, fastest=6.7)
    assert flights(1, of_size(3.0), place) == []
    said = _no_help(named(rivals=(LAG,)), None, place)
    assert "tell motor_saturation and motor_lag apart" in said
    assert "within 0.47 m" in said

"""What motors make of commands, told by the wheels' own encoders."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive
from realitygap.models.belief.catalogue import causes, where
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.driven import wheel_turns
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.motion.diagnose import diagnose
from realitygap.models.naming.channels.motion.tracks import Tracks, cut_tracks
from realitygap.models.naming.channels.wheels.chosen import before_the_encoders, driven_by_encoders
from realitygap.models.naming.channels.wheels.obeyed import obeyed
from realitygap.models.naming.diagnosis import Diagnosis
from tests.models.small import driven_log

MODEL = read_model_file("epuck").model_copy(update={"arena": None})


def table(motors: Drive, *, slip: float = 1.0, rows: int = 2400, seed: int = 3) -> pd.DataFrame:
    """Two minutes of a robot whose wheels do as motors have it, and whose body slips."""
    radius = (slip * 0.0205, slip * 0.0205)
    body = replace(motors, wheel_radius=radius)
    frame = driven_log(
        seed, robots=1, rows=rows, step=0.05, drive=body, position_noise=5e-4, heading_noise=5e-3
    )
    t = frame["t"].to_numpy()
    commands = frame[["cmd_left", "cmd_right"]].to_numpy()
    angle = wheel_turns(t, commands, np.array([0, rows]), motors, 0.0)
    speed = np.diff(angle, axis=0, prepend=angle[:1]) / 0.05
    speed += np.random.default_rng(seed).normal(0.0, 0.02, speed.shape)
    return frame.assign(wheel_left=speed[:, 0], wheel_right=speed[:, 1])


def tracks(frame: pd.DataFrame) -> Tracks:
    return cut_tracks(make_log(frame, drive=Drive()), MODEL)


@cache
def said(motors: Drive, slip: float = 1.0) -> Diagnosis:
    return diagnose(make_log(table(motors, slip=slip), drive=Drive()), MODEL, None).diagnosis


def found(motors: Drive, slip: float = 1.0) -> dict[str, tuple[float, float, float]]:
    """First value and interval by name."""
    return {
        one.term.cause.name: (one.values[0].value, one.values[0].low, one.values[0].high)
        for one in said(motors, slip).named
    }


def test_the_catalogue_is_cut_where_the_encoders_are() -> None:
    before = {name for name, cause in causes().items() if before_the_encoders(cause)}
    assert {"command_latency", "motor_lag", "motor_saturation", "motor_dead_zone"} <= before
    assert not before & {"wheel_radius_scale", "wheel_separation", "clock_offset", "low_friction"}


def test_motors_that_obey_are_named_nothing() -> None:
    assert obeyed(tracks(table(Drive())), [Motion()]).named == ()


def test_delay_lag_and_limit_are_told_apart_though_each_hides_the_others() -> None:
    told = found(Drive(latency=0.25, time_constant=0.5, speed_limit=(4.0, 4.0)))
    assert set(told) == {"command_latency", "motor_lag", "motor_saturation"}
    for name, true in (("command_latency", 0.25), ("motor_lag", 0.5), ("motor_saturation", 4.0)):
        value, low, high = told[name]
        assert value == pytest.approx(true, rel=0.03), name
        assert low < true * 1.01, name
        assert high > true * 0.99, name


def test_a_dead_zone_and_a_limit_are_found_as_a_pair() -> None:
    told = found(Drive(dead_zone=(1.5, 1.5), speed_limit=(4.0, 4.0)))
    assert set(told) == {"motor_dead_zone", "motor_saturation"}
    assert told["motor_dead_zone"][1] <= 1.5 <= told["motor_dead_zone"][2]


def test_a_limit_of_one_wheel_is_said_of_that_wheel() -> None:
    motors = Drive(speed_limit=(4.0, np.inf))
    (one,) = said(motors).named
    assert (one.term.cause.name, one.term.variant) == ("motor_saturation", "left")


def test_what_the_body_does_is_judged_by_what_the_wheels_did() -> None:
    told = found(Drive(latency=0.25, time_constant=0.5), slip=0.8)
    assert set(told) == {"command_latency", "motor_lag", "wheel_radius_scale"}
    assert told["wheel_radius_scale"][1] < 0.8 < told["wheel_radius_scale"][2]
    assert all(one.exported for one in said(Drive(latency=0.25, time_constant=0.5), 0.8).named)


def test_wheels_at_another_speed_than_told_are_a_motors_gain() -> None:
    frame = table(Drive())
    frame[["x", "y"]] *= 0.9
    frame[["wheel_left", "wheel_right"]] *= 0.9
    frame["yaw"] *= 0.9
    with where("differential", measured=False):
        (one,) = obeyed(tracks(frame), [Motion()]).named
    assert one.term.cause.name == "motor_gain"
    assert [value.value for value in one.values] == pytest.approx([0.9, 0.9], rel=2e-3)


def test_encoders_become_commands_of_the_time_that_they_were_counted_in() -> None:
    cut = tracks(table(Drive(), rows=400))
    assert cut.encoders is not None
    driven, motions = driven_by_encoders(cut, [Motion(drive=Drive(latency=0.2))])
    assert (driven.commands[:-1] == cut.encoders[1:]).all()
    assert motions[0].drive == Drive()


def test_each_half_of_the_log_gives_its_own_values() -> None:
    told = obeyed(tracks(table(Drive(time_constant=0.5))), [Motion()])
    (one,) = told.named
    halves = [part[one.key][0].value for part in told.by_part]
    assert halves[0] != halves[1]
    assert halves == pytest.approx([0.5, 0.5], rel=0.05)


def test_a_log_with_encoders_is_not_said_to_have_none() -> None:
    told = said(Drive(latency=0.25, time_constant=0.5), 0.8)
    assert not [one for one in told.not_checked if "encoders" in one]
    shown = {one.cause: one.size for one in told.detectable}
    assert not {name for name in shown if before_the_encoders(causes()[name])}
    assert 0.0 < (shown["wheel_radius_scale"] or 0.0) < 0.2
    assert told.untold == {}


def test_a_robot_that_stands_and_one_of_a_single_row_disturb_nobody() -> None:
    frame = table(Drive(time_constant=0.5), rows=1200)
    still = frame.assign(robot=1, x=1.0, y=1.0, yaw=0.0)
    still[["cmd_left", "cmd_right", "wheel_left", "wheel_right"]] = 0.0
    every = pd.concat([frame, still, frame.iloc[:1].assign(robot=2)])
    found = diagnose(make_log(every, drive=Drive()), MODEL, None).diagnosis
    assert [(one.term.cause.name, one.robots) for one in found.named] == [("motor_lag", (0,))]

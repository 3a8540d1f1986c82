"""Maps that are guessed: what is guessed is read, and is the log that it was made from."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.belief.modelfile import load_model
from realitygap.models.log.formats.guess import guess
from realitygap.models.log.formats.headers import understood
from realitygap.models.log.formats.tabular import Asked, by_any_map
from realitygap.models.log.measured import make_log
from tests.models.small import driven_log, shared_data

DRIVE = Drive()
ASKED = Asked(drive=DRIVE)
FRAME = driven_log(3, rows=800, position_noise=5e-4, heading_noise=5e-3)
LOG = make_log(FRAME, drive=DRIVE)
T, X, Y, YAW = (FRAME[name] for name in ("t", "x", "y", "yaw"))
LEFT, RIGHT = FRAME["cmd_left"], FRAME["cmd_right"]
V, OMEGA = 0.0205 * (LEFT + RIGHT) / 2, 0.0205 * (RIGHT - LEFT) / 0.053
STEPS = 1000 / (2 * np.pi)
ROBOT = FRAME["robot"]

LABS = {
    "the log's own names": FRAME,
    "units in the headers": {
        **{"stamp_ms": T * 1e3, "pos_x_mm": X * 1e3, "pos_y_mm": Y * 1e3},
        **{"heading_deg": np.degrees(YAW), "v": V, "w": OMEGA, "id": ROBOT},
    },
    "units in brackets": {
        **{"time [ms]": T * 1e3, "x [cm]": X * 100, "y [cm]": Y * 100, "yaw (rad)": YAW},
        **{"cmd v [mm/s]": V * 1000, "cmd w [deg/s]": np.degrees(OMEGA), "robot_id": ROBOT},
    },
    "no units at all": {
        **{"timestamp": (T * 1e9).round().astype("int64") + 17 * 10**17, "X": X * 1e3},
        **{"Y": Y * 1e3, "theta": -np.degrees(YAW), "left_speed": LEFT * STEPS},
        **{"right_speed": RIGHT * STEPS, "name": ROBOT.map({0: "ann", 1: "bob"}), "battery": 3.7},
    },
    "messages written out": {
        **{"%time": (T * 1e9).round().astype("int64"), "field.pose.pose.position.x": X},
        **{"field.pose.pose.position.y": Y, "field.pose.pose.orientation.x": 0.0},
        **{"field.pose.pose.orientation.y": 0.0},
        **{"field.pose.pose.orientation.z": np.sin(YAW / 2)},
        **{"field.pose.pose.orientation.w": np.cos(YAW / 2), "cmd.linear.x": V},
        **{"cmd.angular.z": OMEGA, "odom.linear.x": 9.0, "robot": ROBOT},
    },
    "dates, and speeds of the rims": {
        "time": pd.to_datetime(T, unit="s", origin="2024-05-01").dt.strftime("%FT%T.%f"),
        **{"x": X, "y": Y, "yaw": YAW, "vl": LEFT * 0.0205, "vr": RIGHT * 0.0205, "robot": ROBOT},
    },
    "commands beside what was measured": {
        **{"t": T, "x": X, "y": Y, "yaw": YAW, "v": V * 3, "omega": OMEGA * 3},
        **{"cmd_vel_linear_x": V, "cmd_vel_angular_z": OMEGA, "robot": ROBOT},
    },
}


@pytest.mark.parametrize("lab", LABS)
def test_what_is_guessed_reads_the_log_that_was_meant(lab):
    raw = pd.DataFrame(LABS[lab])
    table, text = by_any_map(raw, Path("lab.csv"), ASKED)
    log = make_log(table, drive=DRIVE)
    assert np.allclose(log.commands, LOG.commands, atol=1e-6)
    assert np.allclose(log.poses[:, :2], LOG.poses[:, :2])
    assert np.allclose(np.exp(1j * log.poses[:, 2]), np.exp(1j * LOG.poses[:, 2]))
    assert np.allclose(log.t - log.t[0], LOG.t - LOG.t[0], atol=1e-5)
    assert "look twice" not in text
    again, nothing = by_any_map(raw, Path("lab.csv"), Asked(drive=DRIVE, guessed=text))
    pd.testing.assert_frame_equal(again, table)
    assert nothing == text


def test_what_is_not_used_is_told():
    text = guess(pd.DataFrame(LABS["no units at all"]), Path("lab.csv"), drive=DRIVE)
    assert "# Not used: battery." in text
    assert text.startswith("# Guessed from lab.csv.")


def test_counts_that_are_left_out_are_told_how_to_be_named():
    raw = FRAME.assign(ticks_left=0, ticks_right=0)
    text = guess(raw, Path("lab.csv"), drive=DRIVE)
    assert 'wheel_left = { from = "...", unit = "ticks", per_turn = ... }' in text
    assert text.index("# Not used: ticks_left") < text.index("# Encoders may be named")


def test_motion_that_follows_no_command_is_told():
    raw = FRAME.assign(cmd_left=LEFT.to_numpy()[::-1], cmd_right=RIGHT.to_numpy()[::-1])
    assert "look twice" in guess(raw, Path("lab.csv"), drive=DRIVE)


def test_a_robot_that_drives_badly_is_not_taken_for_one_in_other_units():
    # on ice: 0.4 of the speed and 0.3 of the turn that it is told
    slow = driven_log(3, rows=800, drive=Drive(wheel_radius=(0.0082, 0.0082), axle=0.071))
    columns = tomllib.loads(guess(slow, Path("lab.csv"), drive=DRIVE))["columns"]
    assert {one["unit"] for name, one in columns.items() if name not in ("run", "robot")} == {
        *("s", "m", "rad", "rad/s")
    }


def test_wheels_of_the_logs_own_name_are_speeds():
    raw = FRAME.assign(wheel_left=LEFT, wheel_right=RIGHT)
    assert tomllib.loads(guess(raw, Path("lab.csv"), drive=DRIVE))["columns"]["wheel_left"]


def test_millimetres_throughout_are_told_by_what_the_robot_can_do():
    raw = pd.DataFrame({"t": T, "x": X * 1e3, "y": Y * 1e3, "yaw": YAW, "v": V * 1e3, "w": OMEGA})
    raw = raw[ROBOT == 0]
    for fastest, unit in ((None, "m"), (6.28, "mm")):
        text = guess(raw, Path("lab.csv"), drive=DRIVE, fastest=fastest)
        assert tomllib.loads(text)["columns"]["x"]["unit"] == unit


@pytest.mark.parametrize(
    ("dropped", "said"),
    [
        ("t", "looks like t among"),
        ("x", "like x "),
        ("x", '[columns], then lines as x = "HEADER"'),
        ("cmd_left", "commands"),
        ("cmd_left", 'cmd_v = "HEADER"'),
    ],
)
def test_what_is_missing_is_named_with_what_is_there(dropped, said):
    with pytest.raises(InputError) as caught:
        guess(FRAME.drop(columns=dropped), Path("lab.csv"), drive=DRIVE)
    assert said in str(caught.value)
    assert "--map" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "m"), (1e3, "mm")])
def test_units_of_positions_without_a_heading_are_told_by_where_robots_go(factor, unit):
    raw = FRAME.drop(columns="yaw").assign(x=factor * FRAME["x"], y=factor * FRAME["y"])
    columns = tomllib.loads(guess(raw, Path("lab.csv"), drive=DRIVE))["columns"]
    assert "yaw" not in columns
    assert columns["x"]["unit"] == unit


def test_a_table_without_names_is_told_what_it_lacks():
    raw = FRAME.drop(columns="run")
    raw.columns = [str(value) for value in raw.iloc[0]]
    with pytest.raises(InputError, match="got numbers in the first line, expected the names"):
        guess(raw, Path("lab.csv"), drive=DRIVE)


@pytest.mark.parametrize(
    ("header", "column", "unit"),
    [
        ("x", "x", ""),
        ("pose.position.x", "x", ""),
        ("linear.x", "cmd_v", ""),
        ("px_mm", "x", "mm"),
        ("Time (s)", "t", "s"),
        ("%time", "t", ""),
        ("headingDeg", "yaw", "deg"),
        ("q_w", "qw", ""),
        ("orientation.z", "qz", ""),
        ("cmd_vel.angular.z", "cmd_omega", ""),
        ("wheel_left [rad/s]", "wheel_left", "rad/s"),
        ("cmd_left", "cmd_left", ""),
        ("vr", "cmd_right", ""),
        ("right motor rpm", "cmd_right", "rpm"),
        ("left_encoder_ticks", "wheel_left", "ticks"),
        ("robot_name", "robot", ""),
        ("trial", "run", ""),
        ("ps3", "ps3", ""),
        ("temperature", "", ""),
        ("cmd", "", ""),
        ("", "", ""),
    ],
)
def test_headers_are_understood(header, column, unit):
    assert understood(header)[:2] == (column, unit)


@pytest.mark.parametrize("name", ["husky-wetgrass", "warthog-ice"])
def test_real_robots_that_slip_keep_the_units_of_their_logs(name):
    raw = pd.read_parquet(shared_data("drive") / f"{name}.parquet")
    drive = load_model(name.partition("-")[0], sensors="ignored").drive
    columns = tomllib.loads(guess(raw, Path("lab.csv"), drive=drive))["columns"]
    assert columns["x"] == {"from": "x", "unit": "m"}
    assert columns["yaw"] == {"from": "yaw", "unit": "rad"}
    assert not {"deg/s", "rpm", "steps/s", "mm/s"} & {
        one["unit"] for one in columns.values() if isinstance(one, dict)
    }

"""Maps: what a lab's columns may be, each against the log that they were made from."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.log.formats.mapped import read_map
from realitygap.models.log.formats.units import heading
from realitygap.models.log.frames import wrapped
from realitygap.models.log.measured import make_log
from tests.models.small import driven_log, read_mapped

DRIVE = Drive(wheel_radius=(0.03, 0.04))
FRAME = driven_log(5, rows=400, drive=DRIVE)
EXPECTED = make_log(FRAME, drive=DRIVE)
PLAIN = {name: name for name in ("t", "x", "y", "yaw", "cmd_left", "cmd_right", "robot")}


def toml(columns):
    lines = [
        f"{name} = {given if given.startswith('{') else repr(given)}"
        for name, given in columns.items()
    ]
    return "\n".join(["[columns]", *lines, ""])


def read(room, frame, columns, more="", **others):
    frame.to_csv(room / "lab.csv", index=False)
    for name, other in others.items():
        other.to_csv(room / f"{name}.csv", index=False)
    (room / "map.toml").write_text(toml(columns) + more)
    return read_mapped(room / "lab.csv", room / "map.toml", drive=DRIVE)


def refusal(*args, **others):
    with pytest.raises(InputError) as caught:
        read(*args, **others)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def quaternions(yaw, tilt=0.0):
    """Columns of a body that is turned by yaw, then tilted about its own y axis."""
    c, s = np.cos(tilt / 2), np.sin(tilt / 2)
    return {
        "qx": -s * np.sin(yaw / 2),
        "qy": s * np.cos(yaw / 2),
        "qz": c * np.sin(yaw / 2),
        "qw": c * np.cos(yaw / 2),
    }


@pytest.mark.parametrize("tilt", [0.0, 0.3])
@pytest.mark.parametrize("size", [1.0, -3.0])
def test_a_yaw_comes_from_a_quaternion_of_any_sign_and_length(tmp_path, tilt, size):
    given = {name: size * part for name, part in quaternions(FRAME["yaw"], tilt).items()}
    table = read(
        tmp_path,
        FRAME.drop(columns="yaw").assign(**given),
        {**PLAIN, "yaw": '{ quaternion = ["qx", "qy", "qz", "qw"] }'},
    )
    assert np.allclose(np.exp(1j * table["yaw"]), np.exp(1j * FRAME["yaw"]))


@given(st.floats(-3.1, 3.1), st.floats(0.1, 10.0))
def test_a_heading_is_the_yaw_of_the_body(yaw, length):
    flat = length * np.array([[0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)]])
    assert heading(flat, "q")[0] == pytest.approx(yaw)


def test_a_quaternion_of_zeros_is_refused(tmp_path):
    frame = FRAME.assign(qx=0.0, qy=0.0, qz=0.0, qw=0.0)
    columns = {**PLAIN, "yaw": '{ quaternion = ["qx", "qy", "qz", "qw"] }'}
    assert "lab.csv: quaternion of yaw: got a quaternion of zeros" in refusal(
        tmp_path, frame, columns
    )


@pytest.mark.parametrize("unit", ["m/s", "cm/s", "mm/s"])
def test_speeds_of_the_rims_become_wheel_speeds_by_each_radius(tmp_path, unit):
    per_metre = {"m/s": 1.0, "cm/s": 100.0, "mm/s": 1000.0}[unit]
    rims = {
        f"cmd_{k}": FRAME[f"cmd_{k}"] * r * per_metre
        for k, r in zip(("left", "right"), DRIVE.wheel_radius, strict=True)
    }
    columns = PLAIN | {n: f'{{ from = "{n}", unit = "{unit}" }}' for n in rims}
    table = read(tmp_path, FRAME.assign(**rims), columns)
    assert np.allclose(make_log(table, drive=DRIVE).commands, EXPECTED.commands)


def turned(frame):
    """Wheel angles (rad) of robots that obey at once, from 0 on."""
    angles = {}
    for side in ("left", "right"):
        steps = frame.groupby("robot")[f"cmd_{side}"].shift(fill_value=0.0) * 0.04
        angles[side] = steps.groupby(frame["robot"]).cumsum()
    return angles


@pytest.mark.parametrize(
    ("given", "per_radian"),
    [
        ('unit = "rad"', 1.0),
        ('unit = "deg"', 180 / np.pi),
        ('unit = "turns"', 0.5 / np.pi),
        ('unit = "ticks", per_turn = 4096', 4096 / (2 * np.pi)),
        ('unit = "ticks", per_turn = 4096, wraps = 1000', 4096 / (2 * np.pi)),
        ('unit = "ticks", per_turn = -4096', None),
    ],
)
@pytest.mark.parametrize("order", [["robot", "t"], ["t", "robot"]])
def test_wheel_angles_become_speeds_since_the_row_before(tmp_path, given, per_radian, order):
    frame = FRAME
    columns = PLAIN | {f"wheel_{k}": f'{{ from = "a_{k}", {given} }}' for k in ("left", "right")}
    for side, angle in turned(FRAME).items():
        count = angle * (per_radian or 1.0)
        frame = frame.assign(**{f"a_{side}": count % 1000 if "wraps" in given else count})
    frame = frame.sort_values(order)
    if per_radian is None:
        assert "per_turn" in refusal(tmp_path, frame, columns)
        return
    log = make_log(read(tmp_path, frame, columns), drive=DRIVE)
    for side in ("left", "right"):
        wanted = FRAME.groupby("robot")[f"cmd_{side}"].shift()
        found = log.frame[f"wheel_{side}"]
        assert found.isna().sum() == 2  # the first row of each robot
        assert np.allclose(found, wanted, equal_nan=True)


@pytest.mark.parametrize("zone", ["Z", "+02:00", ""])
def test_time_may_be_dates(tmp_path, zone):
    since = pd.to_datetime(FRAME["t"], unit="s", origin="2024-05-01")
    stamps = since.dt.strftime("%Y-%m-%dT%H:%M:%S.%f") + zone
    columns = PLAIN | {"t": '{ from = "when", unit = "iso" }'}
    log = make_log(read(tmp_path, FRAME.assign(when=stamps), columns), drive=DRIVE)
    began = 1714521600.0 - (7200.0 if zone == "+02:00" else 0.0)
    assert np.allclose(log.t - began, EXPECTED.t, atol=1e-6)


@pytest.mark.parametrize(("unit", "scale"), [("s", 1), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_time_may_be_stamps_since_1970_in_any_unit(tmp_path, unit, scale):
    stamps = ((FRAME["t"] + 1.7e9) * scale).round(3 if unit == "s" else 0)
    stamps = stamps if unit == "s" else stamps.astype("int64")
    columns = PLAIN | {"t": f'{{ from = "when", unit = "{unit}" }}'}
    log = make_log(read(tmp_path, FRAME.assign(when=stamps), columns), drive=DRIVE)
    assert np.allclose(log.t - 1.7e9, EXPECTED.t, atol=1e-5)


def test_a_date_where_numbers_were_meant_is_told_how_to_be_read(tmp_path):
    frame = FRAME.assign(t="2024-05-01 12:00:00")
    assert 'numbers, or unit = "iso" for dates' in refusal(tmp_path, frame, PLAIN)


def test_what_is_no_date_is_refused(tmp_path):
    columns = PLAIN | {"t": '{ from = "t", unit = "iso" }'}
    said = refusal(tmp_path, FRAME.assign(t="first of May"), columns)
    assert "got first of May, expected dates by ISO 8601" in said


def test_three_files_with_clocks_of_their_own_are_joined_on_time(tmp_path):
    told = FRAME[["robot", "t", "cmd_left", "cmd_right"]]
    seen = FRAME[["robot", "t", "x", "y", "yaw"]].assign(ms=lambda f: 1e3 * f["t"])
    rates = FRAME[["robot", "t"]].assign(ps3=np.arange(len(FRAME)), odom_x=FRAME["x"])
    rates = rates[rates.index % 2 == 0]
    for side, angle in turned(FRAME).items():
        rates[f"a_{side}"] = angle
    more = """
[[files]]
file = "tracker.csv"
columns = { robot = "robot", t = { from = "ms", unit = "ms" }, x = "x", y = "y", yaw = "yaw" }
[[files]]
file = "body.csv"
[files.columns]
robot = "robot"
t = "t"
ps3 = "ps3"
odom_x = "odom_x"
wheel_left = { from = "a_left", unit = "rad" }
wheel_right = { from = "a_right", unit = "rad" }
"""
    columns = {name: name for name in ("t", "cmd_left", "cmd_right", "robot")}
    table = read(tmp_path, told, columns, more, tracker=seen, body=rates)
    log = make_log(table, drive=DRIVE)
    assert np.allclose(log.commands, EXPECTED.commands)
    assert np.allclose(log.poses, EXPECTED.poses)
    part = log.frame[log.frame["robot"] == 1].reset_index(drop=True)
    assert list(part["ps3"][:4]) == [400.0, 400.0, 402.0, 402.0]  # holds until the next
    assert np.allclose(part["odom_x"][:399], part["x"][:399], atol=2e-3)  # in between
    steady = part["cmd_left"].diff().eq(0) & part["cmd_left"].shift().diff().eq(0)
    steady &= steady.shift(-1, fill_value=False)
    assert np.allclose(part["wheel_left"][steady], part["cmd_left"][steady])


def test_robots_that_only_one_file_has_are_left_out(tmp_path):
    told = FRAME[["robot", "t", "cmd_left", "cmd_right"]]
    seen = FRAME[FRAME["robot"] == 1][["robot", "t", "x", "y", "yaw"]]
    more = '[[files]]\nfile = "tracker.csv"\n[files.columns]\nrobot = "robot"\nt = "t"\n'
    more += 'x = "x"\ny = "y"\nyaw = "yaw"\n'
    columns = {name: name for name in ("t", "cmd_left", "cmd_right", "robot")}
    table = read(tmp_path, told, columns, more, tracker=seen)
    assert set(table["robot"]) == {1}


def test_robots_may_have_names(tmp_path):
    table = read(tmp_path, FRAME.assign(robot=FRAME["robot"].map({0: "bob", 1: "al"})), PLAIN)
    assert make_log(table, drive=DRIVE).names == {0: "al", 1: "bob"}


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_map_reads_what_a_spreadsheet_writes(tmp_path, separator, decimal):
    FRAME.to_csv(tmp_path / "lab.csv", index=False, sep=separator, decimal=decimal)
    (tmp_path / "map.toml").write_text(toml(PLAIN))
    table = read_mapped(tmp_path / "lab.csv", tmp_path / "map.toml")
    assert np.allclose(table[list(PLAIN)], FRAME[list(PLAIN)])


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ('yaw = { quaternion = ["qx", "qy", "qz"] }', "quaternion"),
        ('yaw = { quaternion = ["qx", "qy", "qz", "qw"], unit = "deg" }', "the four columns alone"),
        ('x = { quaternion = ["qx", "qy", "qz", "qw"] }', "only for a yaw"),
        ("yaw = { scale = 2.0 }", "expected a column of the file"),
        ('wheel_left = { from = "l", unit = "ticks" }', "ticks of a whole turn"),
        ('wheel_left = { from = "l", unit = "rad", per_turn = 9 }', 'only with unit = "ticks"'),
        ('wheel_left = { from = "l", unit = "rad/s", wraps = 9 }', "wraps"),
        ('cmd_left = { from = "l", unit = "ticks", per_turn = 9 }', "cmd_left.unit"),
        ('cmd_omega = { from = "l", unit = "m/s" }', "cmd_omega.unit"),
        ('x = { from = "l", unit = "iso" }', "x.unit"),
        ('[[files]]\nfile = "a.csv"\ncolumns = { x = "x" }', "no t"),
        ('[[files]]\nfile = "a.csv"\ncolumns = { xx = "x", t = "t" }', "files.0.columns.xx"),
        ('[[files]]\nfil = "a.csv"', "files.0.fil: got an unknown key, expected one of file"),
        ("x = 3", "columns.x: got 3, expected"),
    ],
)
def test_a_wrong_map_is_refused_in_one_line(tmp_path, line, says):
    (tmp_path / "map.toml").write_text(f'[columns]\nt = "t"\n{line}\n')
    with pytest.raises(InputError) as caught:
        read_map(tmp_path / "map.toml")
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_positions_without_a_heading_are_read(tmp_path):
    table = read(tmp_path, FRAME, {k: v for k, v in PLAIN.items() if k != "yaw"})
    log = make_log(table, drive=DRIVE)
    known = log.tracked
    off = np.abs(wrapped(log.poses[known, 2] - FRAME["yaw"].to_numpy()[known]))
    assert known.mean() > 0.3
    assert np.quantile(off, 0.9) < 0.05

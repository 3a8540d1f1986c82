import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.log.measured import make_log, read_log, write_table
from tests.models.small import driven_log

DRIVE = Drive()


def noisy(**changed):
    """A healthy log of two robots, columns changed by functions."""
    frame = driven_log(3, rows=800, position_noise=5e-4, heading_noise=5e-3)
    for name, change in changed.items():
        frame[name] = change(frame[name])
    return frame


def refusal(frame):
    with pytest.raises(InputError) as caught:
        make_log(frame, drive=DRIVE)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_a_healthy_log_is_read_without_a_note():
    assert make_log(noisy(), drive=DRIVE).notes == ()


def test_rows_of_several_robots_may_come_in_the_order_of_time():
    frame = noisy()
    by_time = make_log(frame.sort_values(["t", "robot"]), drive=DRIVE)
    assert by_time.frame.equals(make_log(frame, drive=DRIVE).frame)


@pytest.mark.parametrize("order", [["t", "robot"], ["robot", "t"]])
def test_a_row_without_a_command_breaks_the_track_of_its_own_robot(order):
    frame = driven_log(3, robots=3, rows=800, position_noise=5e-4, heading_noise=5e-3)
    frame.loc[(frame["robot"] == 1) & np.isclose(frame["t"], 10.0), "cmd_left"] = np.nan
    log = make_log(frame.sort_values(order), drive=DRIVE)
    new = np.flatnonzero(np.diff(log.stretch)) + 1
    robot, t = log.frame["robot"].to_numpy()[new], log.t[new]
    assert list(robot) == [1, 1, 2]
    assert np.allclose(t, [0.0, 10.04, 0.0])


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_a_log_comes_back_from_a_file(tmp_path, suffix):
    write_table(noisy(), tmp_path / f"log{suffix}")
    back = read_log(tmp_path / f"log{suffix}", drive=DRIVE)
    pd.testing.assert_frame_equal(back.frame, make_log(noisy(), drive=DRIVE).frame)


def test_of_a_run_only_the_samples_are_read(tmp_path):
    write_table(noisy(), tmp_path / "samples.parquet")
    for name in ("truth.json", "run.json"):
        (tmp_path / name).write_text("this is not to be read")
    assert len(read_log(tmp_path, drive=DRIVE).t) == 1600


def test_body_commands_become_wheel_speeds_by_the_geometry():
    frame = noisy()
    left, right = frame.pop("cmd_left"), frame.pop("cmd_right")
    frame["cmd_v"] = 0.0205 * (left + right) / 2
    frame["cmd_omega"] = 0.0205 * (right - left) / 0.053
    assert np.allclose(make_log(frame, drive=DRIVE).commands, np.column_stack([left, right]))


UNITS = {
    "milliseconds": {"t": lambda v: v * 1e3},
    "microseconds": {"t": lambda v: v * 1e6},
    "nanoseconds": {"t": lambda v: v * 1e9},
    "millimetres": dict.fromkeys("xy", lambda v: v * 1e3),
    "centimetres": dict.fromkeys("xy", lambda v: v * 1e2),
    "yaw looks like degrees": {"yaw": np.degrees},
    "yaw looks like degrees ": {"yaw": lambda v: np.degrees(v) % 360},
    "yaw looks clockwise": {"yaw": lambda v: -v},
    "clockwise degrees": {"yaw": lambda v: -np.degrees(v)},
    "yaw looks like the z of a quaternion": {"yaw": lambda v: np.sin(v / 2)},
    "mirrored": {"yaw": lambda v: -v, "y": lambda v: -v},
    "degrees per second": dict.fromkeys(["cmd_left", "cmd_right"], np.degrees),
    "metres per second": dict.fromkeys(["cmd_left", "cmd_right"], lambda v: v * 0.0205),
    "revolutions per minute": dict.fromkeys(["cmd_left", "cmd_right"], lambda v: v * 9.5493),
    "steps per second": dict.fromkeys(["cmd_left", "cmd_right"], lambda v: v * 1000 / (2 * np.pi)),
    "millimetres and yaw looks like degrees": {
        "x": lambda v: v * 1e3,
        "y": lambda v: v * 1e3,
        "yaw": np.degrees,
    },
}


@pytest.mark.parametrize(("seen", "changes"), UNITS.items(), ids=UNITS.keys())
def test_a_mistake_of_units_is_seen_by_physics_and_named(seen, changes):
    assert seen.strip() in refusal(noisy(**changes))


ALONE = ("millimetres", "centimetres", "yaw looks like degrees", "degrees per second", "metres per",
         "revolutions", "steps")  # fmt: skip


@pytest.mark.parametrize("seen", [name for name in UNITS if name.startswith(ALONE)])
@pytest.mark.parametrize("robots", [2, 5])
def test_a_mistake_of_units_in_one_robot_is_named_with_the_robot(seen, robots):
    frame = driven_log(3, robots=robots, rows=800, position_noise=5e-4, heading_noise=5e-3)
    rows = frame["robot"] == 1
    for name, change in UNITS[seen].items():
        frame.loc[rows, name] = change(frame.loc[rows, name])
    said = refusal(frame.sort_values(["t", "robot"]))
    assert said.startswith("robot 1 in run a: ")
    assert seen.strip() in said


@pytest.mark.parametrize(
    "drive",
    [
        Drive(wheel_radius=(0.0103, 0.0205)),
        Drive(latency=0.5),
        Drive(dead_zone=(5.0, 5.0)),
        Drive(speed_limit=(0.1, 0.1)),
        Drive(speed_limit=(0.5, 0.5)),
        Drive(speed_limit=(6.28, 0.05)),
        Drive(axle=0.15),
    ],
)
def test_one_robot_that_drives_badly_is_not_taken_for_one_in_other_units(drive):
    healthy = driven_log(3, robots=4, rows=800, position_noise=5e-4, heading_noise=5e-3)
    bad = driven_log(4, robots=1, rows=800, drive=drive, position_noise=5e-4, heading_noise=5e-3)
    assert make_log(pd.concat([healthy, bad.assign(robot=9)]), drive=DRIVE).notes == ()


def test_one_robot_that_turns_about_a_point_beside_its_own_is_not_taken_for_one_in_other_units():
    frame = driven_log(3, robots=4, rows=800, position_noise=5e-4, heading_noise=5e-3)
    rows = frame["robot"] == 2
    turned = 2 * 0.0205 * 2.0 / 0.053 * frame.loc[rows, "t"]
    frame.loc[rows, ["cmd_left", "cmd_right"]] = [-2.0, 2.0]
    frame.loc[rows, "x"], frame.loc[rows, "y"] = 0.02 * np.cos(turned), 0.02 * np.sin(turned)
    frame.loc[rows, "yaw"] = turned
    assert make_log(frame, drive=DRIVE).notes == ()


def test_one_robot_with_its_motors_swapped_is_not_taken_for_one_in_other_units():
    frame = driven_log(3, robots=4, rows=800, position_noise=5e-4, heading_noise=5e-3)
    rows = frame["robot"] == 2
    pair = ["cmd_left", "cmd_right"]
    frame.loc[rows, pair] = frame.loc[rows, pair[::-1]].to_numpy()
    assert make_log(frame, drive=DRIVE).notes == ()


def test_one_wrong_unit_throughout_is_seen_by_speeds_no_wheel_reaches():
    frame = noisy(x=lambda v: v * 1e3, y=lambda v: v * 1e3)
    left, right = frame.pop("cmd_left"), frame.pop("cmd_right")
    frame["cmd_v"] = 20.5 * (left + right) / 2
    frame["cmd_omega"] = 0.0205 * (right - left) / 0.053
    with pytest.raises(InputError, match="millimetres throughout"):
        make_log(frame, drive=DRIVE, fastest=6.28)


@pytest.mark.parametrize(
    "drive",
    [
        Drive(wheel_radius=(0.0103, 0.0103)),
        Drive(wheel_radius=(0.0103, 0.0205)),
        Drive(latency=0.3),
        Drive(time_constant=0.3),
        Drive(dead_zone=(3.0, 3.0)),
        Drive(speed_limit=(2.0, 2.0)),
        Drive(axle=0.1),
    ],
)
def test_a_robot_that_merely_drives_badly_is_not_taken_for_a_mistake_of_units(drive):
    frame = driven_log(4, rows=800, drive=drive, position_noise=5e-4, heading_noise=5e-3)
    assert make_log(frame, drive=DRIVE).notes == ()


def test_one_dead_robot_is_no_reason_to_refuse_the_log():
    frame = noisy()
    rng = np.random.default_rng(np.random.SeedSequence(1))
    frame.loc[frame["robot"] == 1, ["x", "y", "yaw"]] = rng.normal(0, 5e-4, (800, 3))
    assert make_log(frame, drive=DRIVE).notes == ()


def frozen(frame, robots=(0, 1)):
    """The log with robots that stay where they were first seen."""
    for robot in robots:
        rows = frame["robot"] == robot
        frame.loc[rows, ["x", "y", "yaw"]] = frame.loc[rows, ["x", "y", "yaw"]].iloc[0].to_numpy()
    return frame


def test_robots_frozen_at_different_places_while_driven_are_refused():
    assert "one value in every row" in refusal(frozen(noisy()))


def test_robots_frozen_in_place_alone_or_in_heading_alone_are_refused():
    still = frozen(noisy())
    assert refusal(noisy().assign(x=still["x"], y=still["y"])).startswith("x and y: ")
    assert refusal(noisy().assign(yaw=still["yaw"])).startswith("yaw: ")


def test_one_frozen_robot_is_no_reason_to_refuse_the_log():
    assert make_log(frozen(noisy(), robots=(1,)), drive=DRIVE).notes == ()


def test_robots_that_turn_on_the_spot_are_not_taken_for_frozen_ones():
    frame = noisy()
    frame["cmd_left"] = -frame["cmd_right"]
    frame["yaw"] = 2 * 0.0205 * 0.04 / 0.053 * frame.groupby("robot")["cmd_right"].cumsum()
    still = frozen(noisy())
    make_log(frame.assign(x=still["x"], y=still["y"]), drive=DRIVE)


def test_robots_that_do_not_start_at_once_are_not_taken_for_robots_without_commands():
    frame = driven_log(3, robots=3, rows=8000, position_noise=5e-4, heading_noise=5e-3)
    waits = frame["t"] < 300.0
    still = frozen(frame.copy(), robots=(0, 1, 2))
    frame.loc[waits, ["x", "y", "yaw"]] = still.loc[waits, ["x", "y", "yaw"]]
    frame.loc[waits, ["cmd_left", "cmd_right"]] = 0.0
    make_log(frame, drive=DRIVE)


def test_shuffled_time_is_refused_with_the_remedy():
    assert "sort the rows by t" in refusal(noisy().sample(frac=1, random_state=1))


def test_two_robots_under_one_id_are_seen_at_equal_times_and_between_one_another():
    same = noisy(robot=lambda v: 0 * v)
    assert "two numbers" in refusal(same)
    between = noisy()
    between.loc[between["robot"] == 1, "t"] += 0.013
    between["robot"] = 0
    assert "two robots" in refusal(between.sort_values("t"))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"x": lambda v: 0 * v}, "x"),
        ({"x": lambda v: 0 * v, "y": lambda v: 0 * v}, "x and y"),
        ({"yaw": lambda v: 0 * v}, "yaw"),
        ({"t": lambda v: 0 * v}, "time"),
        ({"cmd_left": lambda v: 0 * v, "cmd_right": lambda v: 0 * v}, "commands"),
        ({"x": lambda v: v * np.nan}, "without a pose"),
        ({"x": lambda v: v + np.inf}, "finite"),
        ({"x": lambda v: v.astype(str) + " m"}, "numbers"),
        ({"robot": lambda v: v + 0.5}, "whole numbers"),
        ({"robot": lambda v: v + 0.5}, "robot"),
        ({"robot": lambda v: v - 3}, "got -3, expected whole numbers from 0"),
    ],
)
def test_a_column_that_cannot_be_a_measurement_is_refused(changes, says):
    assert says in refusal(noisy(**changes))


@pytest.mark.parametrize(
    ("renamed", "says"),
    [
        ({"yaw": "theta"}, "is it theta?"),
        ({"t": "time"}, "is it time?"),
        ({"x": "X"}, "is it X?"),
        ({"cmd_left": "other"}, "cmd_left"),
        ({"run": "wheel_lefft"}, "wheel_left"),
        ({"robot": "id"}, "robot"),
    ],
)
def test_a_missing_or_misspelt_column_is_named(renamed, says):
    assert says in refusal(noisy().rename(columns=renamed))


def test_a_column_that_stands_twice_in_a_file_is_refused(tmp_path):
    text = noisy().to_csv(index=False).replace("yaw", "x", 1)
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(InputError, match="columns: got x twice"):
        read_log(tmp_path / "log.csv", drive=DRIVE)


def test_encoders_that_never_count_are_no_encoders():
    still = noisy().assign(wheel_left=0.0, wheel_right=0.0)
    assert refusal(still).startswith("wheel_left and wheel_right: got zero in every row while")
    still[["x", "y", "yaw", "cmd_left", "cmd_right"]] = 0.0
    make_log(still, drive=DRIVE)


@pytest.mark.parametrize("suffix", [".tsv", ".txt"])
def test_tabs_make_a_table_too(tmp_path, suffix):
    noisy().to_csv(tmp_path / f"log{suffix}", sep="\t", index=False)
    back = read_log(tmp_path / f"log{suffix}", drive=DRIVE)
    assert np.allclose(back.poses, make_log(noisy(), drive=DRIVE).poses)


def test_a_column_no_one_knows_is_left_unread_and_said_so():
    log = make_log(noisy().assign(battery=3.7), drive=DRIVE)
    assert "battery" not in log.frame
    assert log.notes == ("column battery is not read",)


def test_empty_logs_are_refused():
    assert "0 rows" in refusal(noisy().iloc[:0])
    assert "two moments" in refusal(noisy().iloc[:1])


def test_what_can_be_repaired_is_repaired_and_counted():
    rng = np.random.default_rng(np.random.SeedSequence(2))
    frame = noisy()
    wild = rng.choice(700, 21, replace=False) + 50
    frame.loc[wild, "x"] += rng.choice([-1, 1], 21) * rng.uniform(0.3, 1, 21)
    frame.loc[1000:1039, "yaw"] = np.nan
    frame.loc[1300:, "y"] += 0.5
    frame.loc[1200, "cmd_left"] = np.nan
    log = make_log(pd.concat([frame, frame.iloc[[5]]]), drive=DRIVE)
    assert set(wild) <= set(np.flatnonzero(~log.tracked))
    text = " / ".join(log.notes)
    assert "1 repeated rows" in text
    assert "40 rows without a pose set aside (at most 40 in a row)" in text
    assert "far from their neighbours" in text
    assert "1 jumps" in text
    assert "1 rows without time or command dropped" in text
    wild_seen = int(text.split(" poses far")[0].rsplit(" ", 1)[1])
    assert 21 <= wild_seen <= 23


@pytest.mark.parametrize("content", [b"", b"\x00\x01", b"a,b\n1", b"PAR1"])
@pytest.mark.parametrize("name", ["log.parquet", "log.csv", "log.txt", "none.csv"])
def test_a_file_that_is_no_log_is_refused(tmp_path, name, content):
    if not name.startswith("none"):
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError):
        read_log(tmp_path / name, drive=DRIVE)

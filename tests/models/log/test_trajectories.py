"""Trajectories with a table of commands, and data sets of episodes."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.log.formats.lerobot import read_lerobot
from realitygap.models.log.formats.tabular import Asked
from realitygap.models.log.formats.trajectory import read_euroc, read_tum
from realitygap.models.log.measured import make_log
from tests.models.small import driven_log

DRIVE = Drive()
FRAME = driven_log(4, robots=1, rows=500)
EPOCH = 1.7e9
QUATERNION = np.column_stack(
    [0 * FRAME["t"], 0 * FRAME["t"], np.sin(FRAME["yaw"] / 2), np.cos(FRAME["yaw"] / 2)]
)


def write_tum(room):
    poses = np.column_stack([FRAME["t"] + EPOCH, FRAME["x"], FRAME["y"], 0 * FRAME["t"]])
    lines = [" ".join(f"{v:.6f}" for v in row) for row in np.hstack([poses, QUATERNION])]
    (room / "traj.txt").write_text("\n".join(["# timestamp tx ty tz qx qy qz qw", *lines]))
    return room / "traj.txt"


def write_euroc(room):
    folder = room / "mav0" / "state_groundtruth_estimate0"
    folder.mkdir(parents=True)
    stamps = ((FRAME["t"] + EPOCH) * 1e9).round().astype("int64")
    poses = np.column_stack([FRAME["x"], FRAME["y"], 0 * FRAME["t"], QUATERNION[:, [3, 0, 1, 2]]])
    lines = [
        ",".join([str(t), *(f"{v:.6f}" for v in row), "0.1,0.2"])
        for t, row in zip(stamps, poses, strict=True)
    ]
    text = "\n".join(["#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m]", *lines])
    (folder / "data.csv").write_text(text)
    return room


READERS = {"tum": (write_tum, read_tum), "euroc": (write_euroc, read_euroc)}


def write_commands(room, **columns):
    given = columns or {"cmd_left": FRAME["cmd_left"], "cmd_right": FRAME["cmd_right"]}
    path = room / "commands.csv"
    pd.DataFrame({"time": FRAME["t"] + EPOCH, **given}).to_csv(path, index=False)
    return path


def refusal(read, *args):
    with pytest.raises(InputError) as caught:
        read(*args)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("kind", READERS)
def test_a_trajectory_and_its_commands_are_joined_on_time(tmp_path, kind):
    write, read = READERS[kind]
    asked = Asked(drive=DRIVE, commands=write_commands(tmp_path))
    table, text = read(write(tmp_path), asked)
    log, want = make_log(table, drive=DRIVE), make_log(FRAME, drive=DRIVE)
    assert len(log.t) > 490
    held = np.searchsorted(FRAME["t"], log.t - EPOCH + 1e-4) - 1
    assert np.allclose(log.commands, want.commands[held], atol=1e-6)
    assert np.abs(log.poses[:, 0] - np.interp(log.t - EPOCH, FRAME["t"], FRAME["x"])).max() < 1e-5
    assert "[columns]" in text


def test_units_of_commands_are_guessed_by_the_poses_of_the_trajectory(tmp_path):
    left, right = (FRAME[f"cmd_{k}"] * 60 / (2 * np.pi) for k in ("left", "right"))
    asked = Asked(drive=DRIVE, commands=write_commands(tmp_path, left=left, right=right))
    assert 'unit = "rpm"' in read_tum(write_tum(tmp_path), asked).guessed


def test_a_map_of_the_commands_needs_no_poses(tmp_path):
    (tmp_path / "map.toml").write_text(
        '[columns]\nt = "time"\ncmd_left = "cmd_left"\ncmd_right = "cmd_right"\n'
    )
    commands = write_commands(tmp_path)
    asked = Asked(drive=DRIVE, commands=commands, map=tmp_path / "map.toml")
    table, text = read_tum(write_tum(tmp_path), asked)
    assert len(table) > 490
    assert text == ""


def test_a_trajectory_without_commands_is_refused(tmp_path):
    said = refusal(read_tum, write_tum(tmp_path), Asked(drive=DRIVE))
    assert said.startswith("--commands: got nothing, expected a table of the robot's commands")


def test_commands_of_two_robots_are_refused(tmp_path):
    both = {"cmd_left": FRAME["cmd_left"], "cmd_right": FRAME["cmd_right"]}
    both["robot"] = np.arange(len(FRAME)) % 2
    asked = Asked(drive=DRIVE, commands=write_commands(tmp_path, **both))
    assert "commands of 2 robots" in refusal(read_tum, write_tum(tmp_path), asked)


def test_commands_of_another_time_are_refused(tmp_path):
    commands = write_commands(tmp_path)
    frame = pd.read_csv(commands)
    frame.assign(time=frame["time"] - EPOCH).to_csv(commands, index=False)
    asked = Asked(drive=DRIVE, commands=commands)
    assert "two series of one clock" in refusal(read_tum, write_tum(tmp_path), asked)


@pytest.mark.parametrize("text", ["", "1 2 3\n4 5 6\n", "a b c d e f g h\n" * 3])
def test_what_is_no_trajectory_is_refused(tmp_path, text):
    (tmp_path / "a.txt").write_text(text)
    asked = Asked(drive=DRIVE, commands=write_commands(tmp_path))
    refusal(read_tum, tmp_path / "a.txt", asked)
    refusal(read_euroc, tmp_path / "a.txt", asked)
    refusal(read_euroc, tmp_path, asked)


def write_lerobot(room, *, named=True, episodes=2):
    """A data set as recorded: states and actions as lists, time anew in every episode."""
    left, right = FRAME["cmd_left"], FRAME["cmd_right"]
    states = np.column_stack([FRAME["x"], FRAME["y"], FRAME["yaw"]]).astype(np.float32)
    actions = np.column_stack([left, right]).astype(np.float32)
    (room / "meta").mkdir()
    (room / "data" / "chunk-000").mkdir(parents=True)
    features = {
        "observation.state": {"dtype": "float32", "shape": [3], "names": ["x", "y", "theta"]},
        "action": {"dtype": "float32", "names": {"motors": ["left_wheel", "right_wheel"]}},
    }
    info = {"codebase_version": "v2.1", "features": features if named else {}}
    (room / "meta" / "info.json").write_text(json.dumps(info))
    for episode in range(episodes):
        table = pa.table(
            {
                "observation.state": pa.FixedSizeListArray.from_arrays(states.ravel(), 3),
                "action": pa.array(actions.tolist(), pa.list_(pa.float32())),
                "timestamp": FRAME["t"].to_numpy(np.float32),
                "frame_index": np.arange(len(FRAME)),
                "episode_index": np.full(len(FRAME), episode),
                "index": np.arange(len(FRAME)),
                "task": ["drive"] * len(FRAME),
            }
        )
        pq.write_table(table, room / "data" / "chunk-000" / f"episode_{episode:06d}.parquet")
    return room


def test_a_data_set_is_read_by_a_guess_and_its_episodes_are_runs(tmp_path):
    table, text = read_lerobot(write_lerobot(tmp_path), Asked(drive=DRIVE))
    log = make_log(table, drive=DRIVE)
    assert list(log.segments["run"]) == ["0", "1"]
    want = make_log(FRAME, drive=DRIVE)
    assert np.allclose(log.poses[: len(FRAME)], want.poses, atol=1e-5)
    assert np.allclose(log.commands[: len(FRAME)], want.commands, atol=1e-5)
    assert 'cmd_left = { from = "action.left_wheel", unit = "rad/s" }' in text


def test_numbers_without_names_are_called_by_their_places(tmp_path):
    room = write_lerobot(tmp_path, named=False)
    text = """[columns]
t = "timestamp"
x = "observation.state.0"
y = "observation.state.1"
yaw = "observation.state.2"
cmd_left = "action.0"
cmd_right = "action.1"
"""
    (tmp_path / "map.toml").write_text(text)
    asked = Asked(drive=DRIVE, map=tmp_path / "map.toml")
    table, _ = read_lerobot(room, asked)
    assert list(make_log(table, drive=DRIVE).segments["run"]) == ["0", "1"]
    one = next(room.glob("data/**/*1.parquet"))
    assert list(make_log(read_lerobot(one, asked).table, drive=DRIVE).segments["run"]) == ["1"]


def test_what_is_no_data_set_is_refused(tmp_path):
    asked = Asked(drive=DRIVE)
    assert "info.json" in refusal(read_lerobot, tmp_path, asked)
    (tmp_path / "meta").mkdir()
    for text in ("[]", "{}", "no json"):
        (tmp_path / "meta" / "info.json").write_text(text)
        assert "LeRobot" in refusal(read_lerobot, tmp_path, asked)
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "a.parquet").write_bytes(b"nothing")
    (tmp_path / "meta" / "info.json").write_text("{}")
    assert "LeRobot" in refusal(read_lerobot, tmp_path, asked)

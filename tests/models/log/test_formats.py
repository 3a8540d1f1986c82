import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import InputError, replay
from realitygap.models.belief.modelfile import load_model
from realitygap.models.gap.replay import replay_log
from realitygap.models.gap.whole import horizon_errors
from realitygap.models.log.formats.joined import join
from realitygap.models.log.formats.mrclam import read_mrclam
from realitygap.models.log.measured import make_log
from realitygap.models.log.noise import PoseNoise
from tests.models.small import driven_log, random_commands, read_mapped

CREATE = load_model("create", sensors="ignored").drive
EPUCK = load_model("epuck", sensors="ignored").drive
HEADER = "# UTIAS\n# one\n# two\n# Time [s] ...\n"


def utias(directory, *, pose_step, robots=(1, 2), seconds=40.0):
    """A directory as the UTIAS logs are: commands at 67 Hz, poses at their own rate, one clock."""
    rng = np.random.default_rng(np.random.SeedSequence(7))
    directory.mkdir()
    for robot in robots:
        t = 100.0 + np.cumsum(rng.uniform(0.0143, 0.0157, round(seconds / 0.015)))
        wheels = random_commands(rng, len(t), hold=100)
        v = 0.039 * wheels.mean(axis=1)
        omega = 0.039 * (wheels[:, 1] - wheels[:, 0]) / 0.258
        fine = np.union1d(t, np.arange(t[0] + 0.1, t[-1] - 0.1, pose_step))
        held = wheels[np.searchsorted(t, fine, side="right") - 1]
        poses = replay(fine, held, [0, len(fine)], [[0.0, 0.0, 3.0]], drive=CREATE).poses
        poses = poses[~np.isin(fine, t)]
        when = fine[~np.isin(fine, t)]
        for name, rows in (
            ("Odometry", np.column_stack([t, v, omega])),
            ("Groundtruth", np.column_stack([when, poses])),
        ):
            text = "\n".join("\t".join(f"{value:.6f}" for value in row) for row in rows)
            (directory / f"Robot{robot}_{name}.dat").write_text(HEADER + text + "\n")


@pytest.mark.parametrize("pose_step", [0.01, 0.1])
def test_commands_and_poses_at_different_rates_are_joined_on_time(tmp_path, pose_step):
    utias(tmp_path / "MRCLAM_Dataset1", pose_step=pose_step)
    table = read_mrclam(tmp_path / "MRCLAM_Dataset1")
    log = make_log(table, drive=CREATE)
    assert list(log.segments["robot"]) == [1, 2]
    assert set(log.segments["run"]) == {"MRCLAM_Dataset1"}
    errors = horizon_errors(log, replay_log(log, CREATE), PoseNoise(1e-4, 1e-3))
    # what is left is the chord a linear interpolation cuts off an arc, and the command's own step
    most = 1e-4 if pose_step == 0.01 else 2e-3
    assert errors["position_median"].max() < most
    assert errors["heading_median"].max() < 10 * most


def test_poses_are_not_interpolated_across_a_gap():
    t = np.arange(0, 10, 0.1)
    poses = np.column_stack([t, t, 0 * t])
    lost = (t > 4) & (t < 6)
    at, _, joined = join(t + 0.05, np.ones((100, 2)), t[~lost], poses[~lost])
    inside = (at > 4.0) & (at < 6.0)
    assert np.isnan(joined[inside]).all()
    assert np.allclose(joined[~inside, 0], at[~inside])


def test_yaw_is_interpolated_the_short_way_round():
    t = np.array([0.0, 1.0, 2.0])
    poses = np.column_stack([t, t, [3.1, -3.1, -3.0]])
    at, _, joined = join(np.array([0.5, 0.6, 0.7]), np.ones((3, 2)), t, poses)
    expected = np.interp(at, [0, 1], [3.1, -3.1 + 2 * np.pi])
    assert np.allclose(joined[:, 2], expected)


def test_series_that_do_not_overlap_are_refused():
    t = np.arange(5.0)
    with pytest.raises(InputError, match="overlap"):
        join(t, np.ones((5, 2)), t + 100, np.ones((5, 3)))


@pytest.mark.parametrize("damage", ["empty", "text", "missing", "short"])
def test_a_damaged_utias_directory_is_refused(tmp_path, damage):
    path = tmp_path / "d"
    utias(path, pose_step=0.01, robots=(1,), seconds=5)
    poses = path / "Robot1_Groundtruth.dat"
    if damage == "missing":
        poses.unlink()
    elif damage == "empty":
        poses.write_text(HEADER)
    else:
        poses.write_text({"text": "a b c d\n", "short": "1 2\n3 4\n"}[damage])
    with pytest.raises(InputError):
        read_mrclam(path)


MAP = """
[columns]
t = { from = "stamp", unit = "ms" }
x = { from = "px", unit = "mm" }
y = { from = "py", unit = "mm" }
yaw = { from = "heading", unit = "deg", scale = -1 }
cmd_left = { from = "l", unit = "rpm" }
cmd_right = { from = "r", unit = "rpm" }
robot = "id"
"""


def foreign(frame):
    """The log as another lab would write it."""
    return pd.DataFrame(
        {
            "stamp": frame["t"] * 1e3,
            "px": frame["x"] * 1e3,
            "py": frame["y"] * 1e3,
            "heading": -np.degrees(frame["yaw"]),
            "l": frame["cmd_left"] * 60 / (2 * np.pi),
            "r": frame["cmd_right"] * 60 / (2 * np.pi),
            "id": frame["robot"],
        }
    )


def test_a_map_turns_a_labs_own_columns_and_units_into_a_log(tmp_path):
    frame = driven_log(5, rows=300)
    foreign(frame).to_csv(tmp_path / "lab.csv", index=False)
    (tmp_path / "map.toml").write_text(MAP)
    log = make_log(read_mapped(tmp_path / "lab.csv", tmp_path / "map.toml"), drive=EPUCK)
    expected = make_log(frame, drive=EPUCK)
    assert np.allclose(log.poses, expected.poses)
    assert np.allclose(log.commands, expected.commands)


def test_wheel_speeds_may_be_in_the_steps_of_an_epuck(tmp_path):
    frame = driven_log(5, rows=300)
    told = {k: frame[f"cmd_{k}"] * 1000 / (2 * np.pi) for k in ("left", "right")}
    foreign(frame).assign(l=told["left"], r=told["right"]).to_csv(tmp_path / "a.csv", index=False)
    (tmp_path / "map.toml").write_text(MAP.replace("rpm", "steps/s"))
    log = make_log(read_mapped(tmp_path / "a.csv", tmp_path / "map.toml"), drive=EPUCK)
    assert np.allclose(log.commands, make_log(frame, drive=EPUCK).commands)


def test_a_map_may_take_poses_from_a_second_file(tmp_path):
    frame = driven_log(6, rows=400)
    told = foreign(frame)
    seen = told[["stamp", "px", "py", "heading", "id"]].rename(columns={"stamp": "when"})
    told.drop(columns=["px", "py", "heading"]).iloc[3:].to_csv(tmp_path / "a.csv", index=False)
    seen.to_csv(tmp_path / "poses.csv", index=False)
    text = MAP + '[poses]\nfile = "poses.csv"\nt = { from = "when", unit = "ms" }\n'
    (tmp_path / "map.toml").write_text(text)
    log = make_log(read_mapped(tmp_path / "a.csv", tmp_path / "map.toml"), drive=EPUCK)
    errors = horizon_errors(log, replay_log(log, EPUCK), PoseNoise(1e-4, 1e-3))
    assert len(log.segments) == 2
    assert errors["position_median"].max() < 1e-9


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (MAP.replace("stamp", "stmp"), "did you mean stamp"),
        (MAP.replace('"mm"', '"mmm"'), "did you mean mm"),
        (MAP.replace("cmd_left", "cmd_lef"), "did you mean cmd_left"),
        (MAP.replace("unit", "unti"), "unti"),
        (MAP + 'cmd_omega = { from = "l", unit = "steps/s" }\n', "cmd_omega"),
        ("[columns", "TOML"),
        ("", "columns"),
    ],
)
def test_a_wrong_map_is_refused_with_the_nearest_name(tmp_path, text, says):
    foreign(driven_log(5, rows=50)).to_csv(tmp_path / "lab.csv", index=False)
    (tmp_path / "map.toml").write_text(text)
    with pytest.raises(InputError, match=says) as refusal:
        read_mapped(tmp_path / "lab.csv", tmp_path / "map.toml")
    assert "\n" not in str(refusal.value)

"""Bags of ROS 1 and ROS 2, and MCAP: written by the library, read back as the log they were."""

from __future__ import annotations

import importlib.util

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.log.formats import bag as bags
from realitygap.models.log.formats.optiodom import read_optiodom
from realitygap.models.log.formats.rosbag import bag_topics, chain, composed, read_bag
from realitygap.models.log.formats.tabular import Asked
from realitygap.models.log.measured import make_log
from tests.models.bags import EPOCH, KINDS, LATE, commands, poses, together, write_bag
from tests.models.small import driven_log, shared_data

DRIVE = Drive()
ASKED = Asked(drive=DRIVE)
RADIUS, AXLE = DRIVE.wheel_radius[0], DRIVE.axle


def body(seed=3, robots=1, rows=500):
    """A log with commands of the body, which change every 0.8 s."""
    frame = driven_log(seed, robots=robots, rows=rows)
    left, right = frame["cmd_left"], frame["cmd_right"]
    return frame.assign(cmd_v=RADIUS * (left + right) / 2, cmd_omega=RADIUS * (right - left) / AXLE)


FRAME = body()


def refusal(path, asked=ASKED):
    with pytest.raises(InputError) as caught:
        read_bag(path, asked)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def mapped(room, text):
    (room / "map.toml").write_text(text)
    return Asked(drive=DRIVE, map=room / "map.toml")


def check(table, frame=FRAME, late=0.0):
    """The table is the log that was recorded, from the first command to the last."""
    log = make_log(table, drive=DRIVE)
    want = make_log(frame.drop(columns=["cmd_v", "cmd_omega"]), drive=DRIVE)
    assert np.allclose(log.t - EPOCH - late, want.t, atol=1e-5)
    assert np.allclose(log.poses[:, :2], want.poses[:, :2], atol=1e-5)
    assert np.allclose(np.exp(1j * log.poses[:, 2]), np.exp(1j * want.poses[:, 2]), atol=1e-4)
    assert np.allclose(log.commands, want.commands, atol=1e-6)
    return log


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("how", ["stamped", "odometry", "transform"])
def test_a_bag_of_commands_and_poses_comes_back_without_a_map(tmp_path, kind, how):
    say = together(commands(FRAME), poses(FRAME, "/somewhere/pose", how))
    path = write_bag(tmp_path / "bag", kind, say)
    table, text = read_bag(path, ASKED)
    check(table)
    assert 'commands = "/cmd_vel"' in text
    assert ("its own odometry" in text or "own odometry" in text) == (how == "odometry")
    again, _ = read_bag(path, Asked(drive=DRIVE, guessed=text))
    pd.testing.assert_frame_equal(again, table)


@pytest.mark.parametrize("suffix", [".mcap", ".db3"])
def test_the_file_in_a_bag_is_read_without_its_directory(tmp_path, suffix):
    kind = "mcap" if suffix == ".mcap" else "ros2"
    path = write_bag(tmp_path / "bag", kind, together(commands(FRAME), poses(FRAME, "/pose")))
    check(read_bag(next(path.glob(f"*{suffix}")), ASKED).table)


@pytest.mark.parametrize("kind", KINDS)
def test_stamps_of_the_sender_are_used_if_asked(tmp_path, kind):
    say = together(commands(FRAME, stamped=True), poses(FRAME, "/pose"))
    path = write_bag(tmp_path / "bag", kind, say)
    text = 'clock = "stamped"\n[topics]\ncommands = "/cmd_vel"\nposes = "/pose"\n'
    check(read_bag(path, mapped(tmp_path, text)).table, late=LATE)


def test_messages_without_stamps_have_no_clock_of_their_own(tmp_path):
    path = write_bag(tmp_path / "bag", "ros2", together(commands(FRAME), poses(FRAME, "/pose")))
    text = 'clock = "stamped"\n[topics]\ncommands = "/cmd_vel"\nposes = "/pose"\n'
    said = refusal(path, mapped(tmp_path, text))
    assert "clock: got stamped, for /cmd_vel, expected received" in said


def tree(frame):
    """A robot's pose through three links: map > odom > base_footprint > base_link."""

    def say(made):
        for t, x, y, yaw in frame[["t", "x", "y", "yaw"]].itertuples(index=False):
            # the odometry has drifted by a turn of 0.5 rad and a shift
            c, s = np.cos(-0.5), np.sin(-0.5)
            dx, dy = x - 1.0, y - 2.0
            local = c * dx - s * dy, s * dx + c * dy
            base = made.transform(EPOCH + t, "odom", "base_footprint", *local, yaw - 0.5)
            drift = made.transform(EPOCH + t, "map", "odom", 1.0, 2.0, 0.5)
            wheel = made.transform(EPOCH + t, "base_link", "camera", 1.0, 0.0, 1.0)
            yield t, "/tf", "tf2_msgs/msg/TFMessage", made.tf(drift, base, wheel)
        fixed = made.transform(EPOCH, "base_footprint", "base_link", 0.0, 0.0, 0.0)
        yield 0.0, "/tf", "tf2_msgs/msg/TFMessage", made.tf(fixed)

    return say


@pytest.mark.parametrize("kind", KINDS)
def test_poses_come_out_of_a_tree_of_transforms(tmp_path, kind):
    path = write_bag(tmp_path / "bag", kind, together(commands(FRAME), tree(FRAME)))
    table, text = read_bag(path, ASKED)
    assert 'poses = { topic = "/tf", frame = "base_footprint", in = "map" }' in text
    check(table)
    lines = ['commands = "/cmd_vel"', 'poses = { topic = "/tf", frame = "base_link", in = "map" }']
    check(read_bag(path, mapped(tmp_path, "\n".join(["[topics]", *lines]))).table)
    lines[1] = lines[1].replace('"map"', '"moon"')
    said = refusal(path, mapped(tmp_path, "\n".join(["[topics]", *lines])))
    assert "no way from moon to base_link" in said
    said = refusal(path, mapped(tmp_path, '[topics]\ncommands = "/cmd_vel"\nposes = "/tf"\n'))
    assert "several frames in /tf" in said


def test_a_chain_of_frames_is_composed_as_the_motions_one_by_one():
    t = np.array([0.0, 1.0, 2.0])
    half = np.sqrt(0.5)
    ahead = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (3, 1))
    left = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, half, half], (1, 1))
    when, at = composed([(t[:1], left), (t, ahead)])
    assert np.allclose(when, t)
    assert np.allclose(at, [[0.0, 1.0, 0.0, 0.0, 0.0, half, half]] * 3)
    links = {("a", "b"): 0, ("b", "c"): 0, ("d", "d"): 0}
    assert chain(links, "c", "a", "f") == [("a", "b"), ("b", "c")]
    for frame, within in (("d", "a"), ("a", "a"), ("x", "a"), ("a", "c")):
        with pytest.raises(InputError, match="no way"):
            chain(links, frame, within, "f")


def wheels(frame, *, angles=True):
    """Joints that obey at once, another joint beside them; an inertial unit."""
    left, right = (frame[f"cmd_{k}"].to_numpy() for k in ("left", "right"))
    turned = np.cumsum(0.04 * np.column_stack([left, right]), axis=0)

    def say(made):
        names = ["gripper", "wheel_right_joint", "wheel_left_joint"]
        for k, t in enumerate(frame["t"]):
            speeds = [] if angles else [0.0, right[k], left[k]]
            told = [0.0, turned[k - 1, 1], turned[k - 1, 0]] if k else [0.0, 0.0, 0.0]
            message = made.joints(EPOCH + t, names, told if angles else [], speeds)
            yield t, "/joint_states", "sensor_msgs/msg/JointState", message
            yield t, "/imu", "sensor_msgs/msg/Imu", made.imu(EPOCH + t, 0.3)

    return say


@pytest.mark.parametrize("angles", [True, False])
def test_wheels_gyroscope_and_odometry_stand_beside_the_poses(tmp_path, angles):
    drifted = FRAME.assign(x=FRAME["x"] + 0.5)
    say = together(
        commands(FRAME),
        poses(FRAME, "/mocap/pose"),
        poses(drifted, "/odom", "odometry"),
        wheels(FRAME, angles=angles),
    )
    table, text = read_bag(write_bag(tmp_path / "bag", "ros2", say), ASKED)
    assert 'poses = "/mocap/pose"' in text
    log = check(table)
    assert np.allclose(log.frame["odom_x"], FRAME["x"] + 0.5, atol=1e-5)
    assert np.allclose(log.frame["gyro_z"][1:], 0.3)
    before = FRAME["cmd_left"].shift() if angles else FRAME["cmd_left"]
    assert np.allclose(log.frame["wheel_left"][1:], before[1:], atol=1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_robots_are_called_by_their_name_spaces(tmp_path, kind):
    frame = body(robots=2)
    parts = []
    for robot, name in enumerate(("tb3_0", "tb3_1")):
        own = frame[frame["robot"] == robot]
        parts += [commands(own, f"/{name}/cmd_vel"), poses(own, f"/vrpn_client_node/{name}/pose")]
        parts.append(poses(own, f"/{name}/odom", "odometry"))
    table, text = read_bag(write_bag(tmp_path / "bag", kind, together(*parts)), ASKED)
    assert '[robots."tb3_0"]' in text or "[robots.tb3_0]" in text
    log = check(table, frame)
    assert log.names == {0: "tb3_0", 1: "tb3_1"}


def test_name_spaces_that_end_alike_are_told_apart_or_left_to_the_user(tmp_path):
    parts = []
    for name in ("one/base", "two/base"):
        parts += [commands(FRAME, f"/{name}/cmd_vel"), poses(FRAME, f"/{name}/pose")]
    path = write_bag(tmp_path / "bag", "ros2", together(*parts))
    assert "2 topics that could be commands" in refusal(path)
    text = "".join(
        f'[robots."{n}/base"]\ncommands = "/{n}/base/cmd_vel"\nposes = "/{n}/base/pose"\n'
        for n in ("one", "two")
    )
    table = read_bag(path, mapped(tmp_path, text)).table
    assert set(table["robot"]) == {"one/base", "two/base"}


def test_a_goal_is_no_pose_and_a_choice_is_the_users(tmp_path):
    say = together(commands(FRAME), poses(FRAME, "/goal_pose"), poses(FRAME, "/a/pose"))
    assert 'poses = "/a/pose"' in read_bag(write_bag(tmp_path / "a", "ros2", say), ASKED).guessed
    more = together(say, poses(FRAME, "/b/pose"))
    said = refusal(write_bag(tmp_path / "b", "ros2", more))
    assert "2 topics that could be poses: /a/pose, /b/pose, expected one of them" in said


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "neither"),
        ('[topics]\ncommands = "/cmd_vel"\n', "poses"),
        ('[topics]\ncommands = "/cmd_vell"\nposes = "/pose"\n', "did you mean /cmd_vel"),
        ('[topics]\ncommands = "/pose"\nposes = "/pose"\n', "/pose of type geometry_msgs"),
        ('[topics]\ncommand = "/cmd_vel"\nposes = "/pose"\n', "command"),
        ('clock = "wall"\n[topics]\ncommands = "/cmd_vel"\nposes = "/pose"\n', "clock"),
        (
            '[topics]\ncommands = "/cmd_vel"\nposes = "/pose"\nwheels = { topic = "/joint_states", '
            'left = "l", right = "wheel_right_joint" }\n',
            "no l in /joint_states",
        ),
    ],
)
def test_a_wrong_map_of_topics_is_refused_in_one_line(tmp_path, text, says):
    say = together(commands(FRAME), poses(FRAME, "/pose"), wheels(FRAME))
    path = write_bag(tmp_path / "bag", "ros2", say)
    assert says in refusal(path, mapped(tmp_path, text))


def test_the_topics_of_a_bag_are_listed_with_what_they_could_be(tmp_path):
    say = together(commands(FRAME), poses(FRAME, "/odom", "odometry"), wheels(FRAME))
    table = bag_topics(write_bag(tmp_path / "bag", "mcap", say)).set_index("topic")
    assert table.loc["/odom", "could_be"] == "poses, odometry"
    assert table.loc["/odom", "messages"] == len(FRAME)
    assert table.loc["/imu", "could_be"] == "gyro"


@pytest.mark.parametrize("kind", KINDS)
def test_a_topic_that_nobody_spoke_on_is_neither_guessed_nor_offered(tmp_path, kind):
    say = together(commands(FRAME), poses(FRAME, "/pose"))
    quiet = {"/odom": "nav_msgs/msg/Odometry", "/other": "geometry_msgs/msg/PoseStamped"}
    path = write_bag(tmp_path / "bag", kind, say, quiet)
    found = read_bag(path, ASKED)
    assert 'poses = "/pose"' in found.guessed
    assert "odom" not in found.guessed
    check(found.table)
    assert bag_topics(path).set_index("topic").loc["/odom", "could_be"] == ""


def test_what_is_no_bag_is_refused(tmp_path):
    (tmp_path / "a.txt").write_text("no bag")
    assert "a ROS 2 bag's directory" in refusal(tmp_path / "a.txt")
    assert "metadata.yaml" in refusal(tmp_path)
    assert "No such file" in refusal(tmp_path / "b.bag")
    (tmp_path / "c.mcap").write_text("no bag")
    assert "a ROS 2 bag's directory" in refusal(tmp_path / "c.mcap")


def test_a_bag_without_poses_lists_what_it_has(tmp_path):
    path = write_bag(tmp_path / "a", "ros2", commands(FRAME))
    assert "topics /cmd_vel (geometry_msgs/msg/Twist), expected a topic of poses" in refusal(path)
    path = write_bag(tmp_path / "b", "ros2", poses(FRAME, "/pose"))
    assert "expected a topic of geometry_msgs/msg/Twist or" in refusal(path)


def test_without_the_library_it_is_said_what_to_install(tmp_path, monkeypatch):
    path = write_bag(tmp_path / "bag", "ros2", together(commands(FRAME), poses(FRAME, "/pose")))
    found = importlib.util.find_spec
    monkeypatch.setattr(bags, "find_spec", lambda n: None if n == "rosbags" else found(n))
    assert "the extra [ros] to be installed: pip install 'reality-gap[ros]'" in refusal(path)


@pytest.mark.slow
def test_a_real_robots_log_comes_back_from_a_bag(tmp_path):
    directory = shared_data("optiodom") / "circular" / "231220200121"
    drive = read_model_file("optiodom").nominal_drive
    table = read_optiodom(directory, drive=drive)
    frame = table[table["run"] == table["run"].iloc[0]].reset_index(drop=True)
    frame["t"] -= frame["t"].iloc[0]
    for kind in KINDS:
        say = together(commands(frame), poses(frame, "/optitrack/robot/pose"))
        path = write_bag(tmp_path / kind, kind, say)
        log = make_log(read_bag(path, Asked(drive=drive)).table, drive=drive)
        want = make_log(frame, drive=drive)
        assert len(log.t) >= len(want.t) - 1
        assert np.allclose(log.poses[:, :2], want.poses[: len(log.t), :2], atol=1e-5)
        assert np.allclose(log.commands, want.commands[: len(log.t)], atol=1e-6)

"""`realitygap experiment`: the proposed manoeuvre as commands, and what each rival expects."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import realitygap as rg
from realitygap.embedded_sim import Drive, replay
from realitygap.embedded_sim.onboard import Flags, Generation
from realitygap.models.gap.driven import wheel_turns
from realitygap.models.log.formats.bag import hear, open_bag
from realitygap.models.log.measured import make_log
from realitygap.models.log.schema import ENCODERS, LS, PS
from realitygap.models.naming.proposal.expected import Flown, moves, reads
from realitygap.studies.cli import app
from realitygap.studies.diagnosis.plan import topics_of
from tests.golden.answers import log_file
from tests.models.small import driven_log

WEAK = log_file("single-weak_motor")
NAMES = ["weak_motor", "low_friction"]


@pytest.fixture(scope="module")
def diagnosed() -> rg.DiagnosisResult:
    """A log without encoders: weak motors, or slipping wheels."""
    result = rg.diagnose(WEAK)
    assert result.verdict == "ambiguous"
    return result


@pytest.fixture(scope="module")
def found(diagnosed: rg.DiagnosisResult, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("ambiguous") / "diagnosis"
    diagnosed.write(out)
    return out


@pytest.fixture(scope="module")
def planned(found: Path) -> rg.ProposedExperiment:
    return rg.experiment(found)


def test_commands_are_a_table_at_the_logs_rate_that_ends_at_rest(
    planned: rg.ProposedExperiment,
) -> None:
    table, log = planned.commands, rg.read_log(WEAK)
    assert list(table) == ["t", "robot", "cmd_left", "cmd_right"]
    assert set(table["robot"]) == set(log.robots)
    for _, own in table.groupby("robot"):
        assert np.allclose(np.diff(own["t"]), log.step, atol=1e-6)
        assert (own[["cmd_left", "cmd_right"]].iloc[-1] == 0.0).all()
        assert own["t"].iloc[-1] == pytest.approx(120.0)
    fastest = rg.Model.load().file.robot.wheel_speed_max
    assert 0.0 < table[["cmd_left", "cmd_right"]].abs().to_numpy().max() <= fastest


def test_the_commands_take_the_robots_from_their_starts_through_the_manoeuvre(
    planned: rg.ProposedExperiment,
) -> None:
    """A sound robot that follows them without any feedback stays in the arena, clear of others."""
    tracks = []
    for start in planned.content["starts"]:
        own = planned.commands[planned.commands["robot"] == start["robot"]]
        begin = np.array([[start["x"], start["y"], start["yaw"]]])
        wheels = np.ascontiguousarray(own[["cmd_left", "cmd_right"]].to_numpy())
        tracks.append(replay(own["t"].to_numpy(), wheels, [0, len(own)], begin, drive=Drive()))
    poses = np.stack([one.poses for one in tracks])
    assert np.hypot(poses[..., 0], poses[..., 1]).max() < 0.6 - 0.035
    for k in range(len(poses) - 1):
        apart = np.hypot(*(poses[k + 1 :, :, :2] - poses[k, :, :2]).transpose(2, 0, 1))
        assert apart.min() > 2 * 0.035


def test_twins_are_expected_to_differ_in_encoders_alone(planned: rg.ProposedExperiment) -> None:
    assert planned.content["needs"] == list(ENCODERS)
    assert [one["name"] for one in planned.content["rivals"]] == NAMES
    expected = planned.expected
    assert set(expected["channel"]) == set(ENCODERS)
    assert set(expected["robot"]) == {1}
    commands = planned.commands.set_index(["robot", "t"])
    for _, one in expected[expected["cause"] == "low_friction"].iterrows():
        commanded = commands.loc[(1, one["t_start"]), one["channel"].replace("wheel", "cmd")]
        assert one["value"] == pytest.approx(commanded, abs=0.01)  # slipping wheels turn as told
    weak = expected[expected["cause"] == "weak_motor"].set_index("channel")["value"]
    slip = expected[expected["cause"] == "low_friction"].set_index("channel")["value"]
    assert ((weak - slip).abs() > 3.0).all()


def test_a_rival_in_motion_is_told_by_where_it_takes_the_robot() -> None:
    """Analytic: at 6 rad/s a wheel 2 % larger goes 2 % farther; an axle does not show."""
    t = 0.04 * np.arange(100)
    commands = np.full((100, 1, 2), 6.0)
    told = Flown(t, np.zeros((100, 1, 3)), commands, 1)
    plain, larger = (rg.Model.load().file.motion() for _ in range(2))
    larger = type(larger)(drive=Drive(wheel_radius=(0.02091, 0.02091)))
    (one,) = moves(told, [0], [[plain], [larger]], (1e-3, 1e-2))
    assert (one.channel, one.unit) == ("along", "m")
    assert one.values == pytest.approx((6.0 * 0.0205, 6.0 * 0.02091))
    assert one.end - one.begin == pytest.approx(1.0)
    wide = type(larger)(drive=Drive(axle=0.06))
    assert moves(told, [0], [[plain], [wide]], (1e-3, 1e-2)) == ()


def test_a_rival_in_the_senses_is_told_by_what_is_read_there() -> None:
    from dataclasses import replace

    model = rg.Model.load().point()
    t = 0.04 * np.arange(50)
    poses = np.zeros((50, 1, 3))
    poses[:, 0, 0] = np.linspace(0.3, 0.555, 50)  # up to 1 cm before the wall
    told = Flown(t, poses, np.zeros((50, 1, 2)), 1)
    louder = replace(model, senses=replace(model.senses, ps_gain=(2.0,) * 8))
    found = {one.channel: one for one in reads(told, [[model], [louder]])}
    assert set(found) <= set(PS)
    one = found["ps0"]
    assert one.begin == pytest.approx(t[-1])
    assert one.values[1] == pytest.approx(2.0 * one.values[0], rel=0.01)
    nest = replace(model, nest=(model.nest[0], model.nest[1], 0.1))
    (edge,) = reads(told, [[model], [nest]])
    assert (edge.channel, edge.values) == ("nest", (1.0, 0.0))
    assert not set(LS) & set(found)


def test_the_command_writes_the_table_and_what_to_expect(found: Path, tmp_path: Path) -> None:
    out = tmp_path / "commands.csv"
    words = ["experiment", str(found / "diagnosis.json"), "--out", str(out)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert lines[-1] == f"steps for 3 robots, 120 s, tells weak_motor from low_friction. See {out}"
    assert "log wheel_left, wheel_right" in lines
    assert any(
        re.match(r"robot 1, .* wheel_left .*: weak_motor .*, low_friction", x) for x in lines
    )
    table = pd.read_csv(out)
    assert list(table) == ["t", "robot", "cmd_left", "cmd_right"]
    told = CliRunner().invoke(app, [*words, "--force", "--json"])
    assert told.stdout == (tmp_path / "commands.json").read_text(encoding="utf-8")
    content = json.loads(told.stdout)
    assert content["inputs"][0]["file"] == str(found / "diagnosis.json")
    with pytest.raises(rg.InputError, match="does not exist yet"):
        rg.experiment(found, out=out)
    (tmp_path / "thesis.json").write_text("{}")
    with pytest.raises(rg.InputError, match="to replace that this command has written"):
        rg.experiment(found, out=tmp_path / "thesis.csv", force=True)
    assert not (tmp_path / "thesis.csv").exists()


def test_a_diagnosis_in_memory_gives_the_same(
    diagnosed: rg.DiagnosisResult, planned: rg.ProposedExperiment
) -> None:
    same = rg.experiment(diagnosed)
    pd.testing.assert_frame_equal(same.commands, planned.commands)
    for key in ("expected", "starts", "rivals", "ground"):
        assert same.content[key] == planned.content[key]
    assert repr(planned).startswith("Experiment: steps\n")


@pytest.mark.parametrize("name", ["bag", "bag.mcap"])
def test_a_bag_of_twists_says_the_same_as_the_table(
    planned: rg.ProposedExperiment, tmp_path: Path, name: str
) -> None:
    pytest.importorskip("rosbags")
    planned.write(tmp_path / name, format="ros2")
    assert json.loads((tmp_path / "bag.json").read_text())["manoeuvre"] == "steps"
    topics = planned.content["topics"]
    assert topics == {str(k): f"/robot_{k}/cmd_vel" for k in range(3)}
    with open_bag(tmp_path / name) as bag:
        heard = hear(bag, list(topics.values()))
    for robot in range(3):
        said = heard.said((topics[str(robot)],))
        own = planned.commands[planned.commands["robot"] == robot]
        assert said is not None
        assert np.allclose(said.received, own["t"], atol=1e-6)
        left, right = (0.0205 * own[side].to_numpy() for side in ("cmd_left", "cmd_right"))
        assert np.allclose(said.values[:, 0], 0.5 * (left + right))
        assert np.allclose(said.values[:, 1], (right - left) / 0.053)
    planned.write(tmp_path / name, force=True)


def test_robots_have_topics_that_ros_allows() -> None:
    assert topics_of(["alice"]) == ["/cmd_vel"]
    assert topics_of(["alice", 3, "<b>"]) == [
        "/alice/cmd_vel",
        "/robot_3/cmd_vel",
        "/robot__b_/cmd_vel",
    ]
    assert topics_of(["a b", "a-b"]) == ["/robot_0/cmd_vel", "/robot_1/cmd_vel"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"out": "x.txt"}, "--out: got x.txt, expected a file ending in .csv"),
        ({"out": "x.csv", "format": "ros2"}, "a file ending in .mcap or a directory"),
        ({"out": "x", "format": "table"}, "a file ending in .csv or a file ending in .parquet"),
        ({"out": "x.csv", "format": "ros1"}, "--format: got 'ros1'"),
    ],
)
def test_what_cannot_be_written_is_one_error(
    planned: rg.ProposedExperiment, words: dict[str, Any], said: str, tmp_path: Path
) -> None:
    given = {**words, "out": tmp_path / words["out"]}
    with pytest.raises(rg.InputError, match=re.escape(said)):
        planned.write(**given)
    assert not list(tmp_path.iterdir())


def test_without_the_library_for_bags_it_is_asked_for(
    planned: rg.ProposedExperiment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("realitygap.studies.diagnosis.plan.find_spec", lambda name: None)
    with pytest.raises(rg.InputError, match=re.escape("pip install 'reality-gap[ros]'")):
        planned.write(tmp_path / "bag")
    assert not list(tmp_path.iterdir())


def test_a_diagnosis_that_proposes_nothing_has_no_experiment(found: Path, tmp_path: Path) -> None:
    content = json.loads((found / "diagnosis.json").read_text())
    folder = tmp_path / "settled"
    folder.mkdir()
    (folder / "extended.toml").write_bytes((found / "extended.toml").read_bytes())
    (folder / "epuck.npz").write_bytes((found / "epuck.npz").read_bytes())

    def asked(changed: Any) -> None:
        (folder / "diagnosis.json").write_text(json.dumps(changed))
        rg.experiment(folder)

    with pytest.raises(rg.InputError, match="the verdict named, and no manoeuvre proposed"):
        asked({**content, "verdict": "named", "next_experiment": None})
    older = {k: v for k, v in content["next_experiment"].items() if k != "plan"}
    with pytest.raises(rg.InputError, match=r"diagnosis\.json: next_experiment\.plan: got nothing"):
        asked({**content, "next_experiment": older})
    other = {**content["next_experiment"], "name": "stepps"}
    with pytest.raises(rg.InputError, match="did you mean steps"):
        asked({**content, "next_experiment": other})
    plan = {**content["next_experiment"]["plan"], "step": 1e-12}
    wild = {**content["next_experiment"], "plan": plan}
    with pytest.raises(rg.InputError, match=r"next_experiment\.plan\.step: got 1e-12"):
        asked({**content, "next_experiment": wild})
    with pytest.raises(rg.InputError, match="expected the directory of a diagnosis"):
        asked([1])
    with pytest.raises(rg.InputError, match="DIAGNOSIS"):
        rg.experiment(tmp_path)


BURGER = Drive(wheel_radius=(0.033, 0.033), axle=0.16, latency=0.12)
"""A TurtleBot that hears its commands late."""


def by_the_body(log: pd.DataFrame) -> pd.DataFrame:
    """The same log with the commands that a TurtleBot takes."""
    left, right = (0.033 * log[name] for name in ("cmd_left", "cmd_right"))
    given = {"cmd_v": 0.5 * (left + right), "cmd_omega": (right - left) / 0.16}
    return log.drop(columns=["cmd_left", "cmd_right"]).assign(**given)


def test_a_robot_of_ones_own_with_a_name_drives_the_commands_and_is_understood(
    tmp_path: Path,
) -> None:
    """Late commands, or late stamps: the encoders of the second log tell."""
    noise = {"position_noise": 1e-3, "heading_noise": 5e-3}
    first = driven_log(3, robots=1, rows=1200, step=0.05, drive=BURGER, **noise)
    first["x"] += 5.0
    first["robot"] = "<b>alice"
    before = rg.diagnose(by_the_body(first), model="turtlebot3_burger")
    assert before.verdict == "ambiguous"
    assert {"tour", "face-to-face"}.isdisjoint(
        one["name"] for one in before.content["next_experiment"]["menu"]
    )
    before.write(tmp_path / "found")
    planned = rg.experiment(tmp_path / "found")
    room, (start,) = planned.content["ground"], planned.content["starts"]
    assert (start["robot"], room["walled"]) == ("<b>alice", False)
    away = np.hypot(first["x"] - room["x"], first["y"] - room["y"])
    assert room["radius"] == pytest.approx(away.max() + 0.105, rel=0.01)
    own = planned.commands
    t, wheels = own["t"].to_numpy(), np.ascontiguousarray(own[["cmd_left", "cmd_right"]])
    assert np.allclose(np.diff(t), 0.05)
    assert np.abs(wheels).max() <= rg.Model.load("turtlebot3_burger").file.robot.wheel_speed_max
    begin = np.array([[start["x"], start["y"], start["yaw"]]])
    poses = replay(t, wheels, [0, len(t)], begin, drive=BURGER).poses
    assert np.hypot(*(poses[:, :2] - [room["x"], room["y"]]).T).max() + 0.105 < room["radius"]
    poses += np.random.default_rng(4).normal(size=poses.shape) * [1e-3, 1e-3, 5e-3]
    turns = wheel_turns(t, wheels, np.array([0, len(t)]), BURGER, 0.0)
    speeds = np.diff(turns, axis=0, prepend=0.0) / 0.05
    second = own.assign(**dict(zip(("x", "y", "yaw"), poses.T, strict=True)))
    second = second.assign(run="b", **dict(zip(ENCODERS, speeds.T, strict=True)))
    both = [by_the_body(one) for one in (first, second)]
    after = rg.diagnose(both, model="turtlebot3_burger")
    assert after.verdict == "named"
    (cause,) = after.content["causes"]
    assert (cause["name"], cause["robots"]) == ("command_latency", ["<b>alice"])
    assert cause["parameters"]["seconds"]["value"] == pytest.approx(0.12, abs=0.01)


class Driven:
    """Robots that follow a table of commands, whatever becomes of them."""

    def __init__(self, planned: rg.ProposedExperiment) -> None:
        starts = pd.DataFrame(planned.content["starts"])
        self.starts = starts[["x", "y", "yaw"]].to_numpy()
        each = planned.commands.sort_values(["t", "robot"])[["cmd_left", "cmd_right"]]
        self._table = each.to_numpy().reshape(-1, len(starts), 2)
        self._at = 0
        self.commands = self._table[0].copy()
        self.carrying: Flags = np.zeros(len(starts), dtype=np.uint8)
        self.generations: list[Generation] = []
        self.deposits: list[tuple[int, int, int, int]] = []

    def follow(self, poses: Any) -> None:
        self.commands = self._table[min(self._at, len(self._table) - 1)]
        self._at += 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "spec"),
    [
        ("weak_motor", "weak_motor:torque=0.002,robot=1"),
        ("low_friction", "low_friction:friction=0.12,robot=1"),
    ],
)
def test_the_log_of_the_commands_settles_what_the_first_left_open(
    truth: str, spec: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, Any] = {"robots": 3, "effects": [spec]}
    first, second = tmp_path / "first.parquet", tmp_path / "second"
    run = rg.simulate(controller="search", minutes=1.0, seed=401, **asked)
    run.samples.drop(columns=list(ENCODERS)).to_parquet(first, index=False)
    before = rg.diagnose(first)
    assert before.verdict == "ambiguous"
    planned = rg.experiment(before, out=tmp_path / "commands.csv")

    class Follows(Driven):
        def __init__(self, *_: object) -> None:
            super().__init__(planned)

    monkeypatch.setattr("realitygap.studies.run.experiment.Manoeuvre", Follows)
    log = rg.simulate(controller="probe:steps", minutes=2.0, seed=402, out=second, **asked).samples
    monkeypatch.undo()
    commanded = planned.commands[planned.commands["t"] < 120.0 - 1e-6]
    told = log.sort_values(["t", "robot"])[["cmd_left", "cmd_right"]].to_numpy()
    assert np.allclose(told, commanded.sort_values(["t", "robot"])[["cmd_left", "cmd_right"]])
    after = rg.diagnose([first, second])
    causes = {one["name"]: one for one in after.content["causes"]}
    assert truth in causes
    assert not {*NAMES} & {*causes} - {truth}
    assert (causes[truth]["robots"], causes[truth]["alternatives"]) == ([1], [])
    _as_expected(planned, log, truth)


def _as_expected(planned: rg.ProposedExperiment, log: pd.DataFrame, truth: str) -> None:
    """What the encoders read is what was expected of the cause that is true, not of its rival."""
    measured = make_log(log, drive=Drive()).frame.set_index(["robot", "t"])
    (rival,) = {*NAMES} - {truth}
    for (channel, end), each in planned.expected.groupby(["channel", "t_end"]):
        times = measured.loc[1].index.to_numpy()
        read = measured.loc[(1, times[np.abs(times - end).argmin()]), channel]
        values = each.set_index("cause")["value"]
        assert abs(read - values[truth]) < abs(read - values[rival])

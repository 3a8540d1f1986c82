"""Models of one's own robot: made, and noticed where they were forgotten."""

from __future__ import annotations

import tomllib

import pandas as pd
import pytest

import realitygap as rg
from tests.helpers import realitygap
from tests.models.small import arena_log, driven_log


def test_a_model_is_printed_and_taken_wherever_a_model_is(tmp_path):
    done = realitygap("model", "new", "--wheel-radius", 0.033, "--axle", 0.16, "--name", 'a "b"')
    assert done.returncode == 0, done.stderr
    (tmp_path / "tb3.toml").write_text(done.stdout)
    model = rg.Model.load(tmp_path / "tb3.toml")
    assert model.name == 'a "b"'
    robot = model.file.robot
    assert (robot.wheel_radius, robot.axle) == (0.033, 0.16)
    assert robot.body_radius == pytest.approx((0.08**2 + 0.033**2) ** 0.5, abs=1e-4)
    assert robot.wheel_speed_max == pytest.approx(1 / 0.033, abs=0.01)
    assert model.file.arena is None
    assert done.stdout == rg.new_model(wheel_radius=0.033, axle=0.16, name='a "b"')


def test_what_is_given_is_kept():
    text = rg.new_model(wheel_radius=0.03, axle=0.2, body_radius=0.3, wheel_speed_max=9.0)
    assert tomllib.loads(text)["robot"] == {
        **{"wheel_radius": 0.03, "axle": 0.2},
        **{"body_radius": 0.3, "wheel_speed_max": 9.0},
    }


@pytest.mark.parametrize(("key", "value"), [("wheel_radius", 33.0), ("axle", 160.0)])
def test_millimetres_are_not_taken_for_metres(key: str, value: float) -> None:
    with pytest.raises(rg.InputError, match=f"{value:g} mm are {value / 1e3:g} m"):
        rg.new_model(**{"wheel_radius": 0.03, "axle": 0.2, key: value})


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"wheel_radius": 0.0}, "robot.wheel_radius: got 0"),
        ({"wheel_radius": -0.1}, "robot.wheel_radius: got -0.1"),
        ({"axle": float("nan")}, "robot.axle: got nan"),
        ({"axle": float("inf")}, "robot.axle: got inf"),
        ({"body_radius": 1e6}, "robot.body_radius"),
        ({"wheel_speed_max": 0.0}, "robot.wheel_speed_max"),
        ({"name": ""}, "name"),
    ],
)
def test_what_is_no_size_of_a_robot_is_refused(changed, said):
    with pytest.raises(rg.InputError, match="new model") as caught:
        rg.new_model(**{"wheel_radius": 0.03, "axle": 0.2, **changed})
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def fast(frame):
    """The same path driven twice as fast as an e-puck's motors turn."""
    faster = {name: 3.0 * frame[name] for name in ("x", "y", "cmd_left", "cmd_right")}
    return frame.assign(**faster)


def test_a_forgotten_model_is_noticed_by_the_poses_and_the_commands(tmp_path):
    frame = driven_log(1, rows=400)
    (note, *_) = rg.read_log(frame.assign(x=frame["x"] + 2.0)).notes
    assert note.startswith("No --model was given, and the e-puck is assumed")
    assert "100 % of the poses lie beyond the wall of its arena (0.6 m)" in note
    (note, *_) = rg.read_log(fast(frame)).notes
    assert "of the commands are faster than its motors turn (6.28 rad/s)" in note
    far = frame.assign(x=frame["x"] + 2.0)
    far.to_csv(tmp_path / "far.csv", index=False)
    done = realitygap("gap", tmp_path / "far.csv", "--out", tmp_path / "gap")
    assert "No --model was given" in done.stdout
    assert "No --model was given" in " ".join(rg.measure_gap(far).content["log"]["notes"])


def test_a_model_that_was_named_is_nobodys_mistake():
    far = driven_log(1, rows=400).assign(x=lambda f: f["x"] + 2.0)
    for model in ("epuck", "optiodom"):
        assert not any("--model" in note for note in rg.read_log(far, model=model).notes)


def test_a_model_file_that_is_not_there_is_said_to_be_none():
    for wrong in ("mine/robot.toml", "robot.toml"):
        with pytest.raises(rg.InputError, match=f"got {wrong}: no such file"):
            rg.Model.load(wrong)
    with pytest.raises(rg.InputError, match=r"got epuk, expected .*did you mean epuck"):
        rg.Model.load("epuk")


def test_a_log_is_told_in_words_that_agree_in_number():
    one, two = driven_log(1, robots=1, rows=5), driven_log(1, robots=2, rows=5)
    assert rg.read_log(one.assign(run="a")).size == "5 rows, 1 run, 1 robot, a row each 0.04 s"
    assert rg.read_log(two.assign(run="a")).size == "10 rows, 1 run, 2 robots, a row each 0.04 s"


def test_an_epuck_in_its_arena_needs_no_model():
    frame = pd.DataFrame(arena_log(1, robots=2, rows=400))
    assert not any("--model" in note for note in rg.read_log(frame).notes)

"""Every condition does to a log what its name says, and nothing else."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from realitygap.models.log.table_files import RECORDER
from realitygap.reality import constants as k
from realitygap.studies.blind.conditions import changes as c
from realitygap.studies.blind.conditions import matrix
from realitygap.studies.blind.conditions.battery import write_given
from realitygap.studies.blind.conditions.matrix import CONDITIONS, matrix_config, plan
from realitygap.studies.inputs.imported import read_log
from realitygap.studies.inputs.model import Model

STEP, ROWS, SPEED, TURN = 0.04, 300, 0.1, 3.0
"""s, rows of a robot, m/s along a line, rad/s of a spin that passes pi."""


def line(robots: int = 3, rows: int = ROWS) -> pd.DataFrame:
    """Robots on straight lines whose headings turn; every other column tells its row's time."""
    t = np.repeat(np.arange(rows) * STEP, robots)
    robot = np.tile(np.arange(robots), rows)
    told = np.round(t / STEP)
    return pd.DataFrame(
        {
            "run": "log",
            "robot": robot,
            "t": t,
            "x": SPEED * t + robot,
            "y": -2.0 * SPEED * t,
            "yaw": np.remainder(TURN * t + math.pi, 2.0 * math.pi) - math.pi,
            "cmd_left": told,
            "cmd_right": told,
            "wheel_left": told,
            "wheel_right": told,
            "ps0": told.astype(np.uint16),
            "ls0": told.astype(np.uint16),
            "food": told % 2 == 0,
            "nest": told % 2 == 1,
            "case": "no-light",
        }
    )


def changed(change: c.Change, log: pd.DataFrame | None = None, seed: int = 1) -> pd.DataFrame:
    return change(line() if log is None else log, np.random.default_rng(seed))


def of_robot(log: pd.DataFrame, robot: int = 1) -> pd.DataFrame:
    return log[log["robot"] == robot].reset_index(drop=True)


def off(first: pd.Series, second: pd.Series) -> np.ndarray:
    """rad between two headings."""
    return np.abs(np.remainder(first - second + math.pi, 2.0 * math.pi) - math.pi).to_numpy()


NULLS: dict[str, c.Change] = {
    "nothing": c.unchanged,
    "every row": c.every_nth(1),
    "a pose in every row": c.pose_every(1),
    "held for one row": c.held(1),
    "no more noise": c.noisier(1.0),
    "no outliers": c.outliers(0.0),
    "no jitter": c.jittered(0.0),
    "the same frame": c.framed(),
    "all seconds": c.first(1e6),
    "no column": c.without("none"),
    "the same rate": c.resampled(1.0 / STEP),
    "averages of one": c.averaged(1),
    "clocks of one rate": c.tracker_fast(0.0),
}


@pytest.mark.parametrize("name", NULLS)
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_at_its_null_a_condition_changes_nothing(name: str, seed: int) -> None:
    log = line(rows=20)
    log[["x", "y"]] += np.random.default_rng(seed).normal(0.0, 0.1, (len(log), 2))
    after = changed(NULLS[name], log, seed)
    order = ["robot", "t"]
    pd.testing.assert_frame_equal(
        after.sort_values(order).reset_index(drop=True),
        log.sort_values(order).reset_index(drop=True),
        rtol=1e-9,
        atol=1e-12,
    )


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_condition_is_pure_and_time_goes_on_increasing(name: str) -> None:
    log, change = line(), CONDITIONS[name].change
    after = changed(change, log)
    pd.testing.assert_frame_equal(log, line())
    pd.testing.assert_frame_equal(after, changed(change, log))
    assert {"run", "robot", "t", "x", "y", "cmd_left", "cmd_right"} <= set(after)
    assert (after.groupby("robot")["t"].diff().dropna() > 0.0).all()
    assert after[["t", "cmd_left"]].notna().all(axis=None)


@pytest.mark.parametrize("n", [2, 4])
def test_every_nth_row_is_left_of_each_robot(n: int) -> None:
    after = of_robot(changed(c.every_nth(n)))
    assert after["cmd_left"].tolist() == list(range(0, ROWS, n))
    assert after["t"].to_numpy() == pytest.approx(np.arange(0, ROWS, n) * STEP)


@pytest.mark.parametrize("rate", [10.0, 12.5, 20.0, 50.0])
def test_rows_at_another_rate_lie_on_the_line_with_the_last_command(rate: float) -> None:
    after = of_robot(changed(c.resampled(rate)))
    assert np.diff(after["t"]) == pytest.approx(1.0 / rate)
    assert after["t"].iloc[-1] > (ROWS - 1) * STEP - 1.0 / rate
    assert after["x"].to_numpy() == pytest.approx(SPEED * after["t"] + 1.0)
    assert off(after["yaw"], TURN * after["t"]).max() < 1e-9
    assert after["cmd_left"].tolist() == np.floor(after["t"] / STEP + 1e-6).tolist()


def test_between_two_poses_an_interpolated_one_is_their_mean() -> None:
    log = line(robots=1, rows=3)
    log["x"] = [0.0, 1.0, 4.0]
    assert changed(c.resampled(50.0), log)["x"].tolist() == pytest.approx([0.0, 0.5, 1.0, 2.5, 4.0])


@pytest.mark.parametrize("n", [2, 5])
def test_poses_are_left_in_every_nth_row_and_commands_in_all(n: int) -> None:
    before, after = of_robot(line()), of_robot(changed(c.pose_every(n)))
    there = np.arange(ROWS) % n == 0
    for name in c.POSE:
        assert (after[name].notna() == there).all()
        assert (after[name][there] == before[name][there]).all()
    assert (after["cmd_left"] == before["cmd_left"]).all()


def test_held_poses_repeat_the_one_before() -> None:
    before, after = of_robot(line()), of_robot(changed(c.held(2)))
    assert (after["x"].to_numpy() == before["x"].to_numpy()[np.arange(ROWS) // 2 * 2]).all()
    assert (after["t"] == before["t"]).all()


@pytest.mark.parametrize("n", [3, 5])
def test_averages_keep_a_line_and_divide_noise_by_their_number(n: int) -> None:
    after = of_robot(changed(c.averaged(n)))
    inside = slice(n // 2, ROWS - n // 2)
    assert after["x"][inside].to_numpy() == pytest.approx(of_robot(line())["x"][inside])
    assert off(after["yaw"], of_robot(line())["yaw"])[inside].max() < 1e-9
    log = line(robots=1, rows=6000)
    log["x"] = np.random.default_rng(3).standard_normal(len(log))
    assert changed(c.averaged(n), log)["x"].var() == pytest.approx(1.0 / n, rel=0.1)


def test_a_causal_filter_lags_behind_a_ramp_by_what_first_order_says() -> None:
    after = of_robot(changed(c.lowpassed(0.08)))
    left = math.exp(-STEP / 0.08)
    lag = STEP * left / (1.0 - left)  # s; the time constant less half a row
    assert lag == pytest.approx(0.08 - STEP / 2.0, rel=0.05)
    late = slice(50, None)
    assert (of_robot(line())["x"] - after["x"])[late].to_numpy() == pytest.approx(SPEED * lag)
    assert off(after["yaw"], TURN * (after["t"] - lag))[late].max() < 1e-6


@pytest.mark.parametrize("times", [2.0, 4.0])
def test_noise_is_added_until_it_is_that_many_times_the_trackers(times: float) -> None:
    log = line(rows=4000)
    added = changed(c.noisier(times), log)[c.POSE] - log[c.POSE]
    scale = np.array([k.TRACKER_NOISE, k.TRACKER_NOISE, k.TRACKER_YAW_NOISE])
    whole = np.hypot(added.std(), scale) / scale
    assert whole.to_numpy() == pytest.approx(times, rel=0.03)
    assert np.abs(added.mean() / scale).max() < 5.0 * times / math.sqrt(len(log))


def test_two_percent_of_poses_are_thrown_and_no_other_moves() -> None:
    log = line(rows=4000)
    after = changed(c.outliers(0.02), log)
    thrown = (after["x"] != log["x"]).to_numpy()
    assert thrown.mean() == pytest.approx(0.02, abs=5.0 * math.sqrt(0.02 / len(log)))
    assert (after[c.POSE][~thrown] == log[c.POSE][~thrown]).all(axis=None)
    assert (after["x"] - log["x"])[thrown].std() == pytest.approx(c.OUTLIER[0], rel=0.2)


def test_quantised_poses_are_whole_steps_next_to_the_poses() -> None:
    log = line()
    after = changed(CONDITIONS["quantised"].change, log)
    for name, step in zip(c.POSE, (1e-3, 1e-3, math.radians(1.0)), strict=True):
        steps = after[name] / step
        assert np.abs(steps - np.rint(steps)).max() < 1e-6
        assert np.abs(after[name] - log[name]).max() <= 0.5 * step + 1e-12
        assert (after[name] != log[name]).any()


def test_stamps_jitter_by_five_milliseconds() -> None:
    log = line(rows=4000)
    jitter = changed(c.jittered(0.005), log)["t"] - log["t"]
    assert jitter.std() == pytest.approx(0.005, rel=0.05)
    assert abs(jitter.mean()) < 1e-4


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("direction", ["nearest", "backward"])
def test_merged_commands_are_the_last_or_the_nearest(direction: str, seed: int) -> None:
    after = of_robot(changed(c.merged(direction), seed=seed))
    assert after["x"].to_numpy() == pytest.approx(SPEED * after["t"] + 1.0)
    ahead = after["cmd_left"] * STEP - after["t"]  # s from the pose to when it was commanded
    assert ahead.std() < 1e-9
    low, high = (-STEP, 0.0) if direction == "backward" else (-0.5 * STEP, 0.5 * STEP)
    assert low < ahead.iloc[0] < high
    assert (after["wheel_left"] == after["cmd_left"]).all()


def test_poses_of_a_tracker_with_a_fast_clock_fall_behind_by_a_thousandth() -> None:
    after = of_robot(changed(c.tracker_fast(1e-3)))
    assert after["x"].to_numpy() == pytest.approx(SPEED * after["t"] / 1.001 + 1.0)
    assert (after["t"] == of_robot(line())["t"]).all()
    assert (after["cmd_left"] == of_robot(line())["cmd_left"]).all()


def test_a_quarter_turn_maps_x_to_y() -> None:
    log = line()
    after = changed(CONDITIONS["turned-90"].change, log)
    assert after["x"].to_numpy() == pytest.approx(-log["y"])
    assert after["y"].to_numpy() == pytest.approx(log["x"])
    assert off(after["yaw"], log["yaw"] + math.pi / 2.0).max() < 1e-9


@settings(deadline=None)
@given(angle=st.floats(-6.0, 6.0), x=st.floats(-3.0, 3.0), scale=st.floats(0.5, 2.0))
def test_another_frame_keeps_distances_and_can_be_undone(
    angle: float, x: float, scale: float
) -> None:
    log = line(robots=2, rows=10)
    after = changed(c.framed(angle, scale, (x, -x)), log)
    lengths = [np.hypot(one["x"].diff(), one["y"].diff())[1:].to_numpy() for one in (log, after)]
    assert lengths[1] == pytest.approx(scale * lengths[0])
    back = changed(c.framed(shift=(-x, x)), after)
    back = changed(c.framed(-angle, 1.0 / scale), back)
    assert back[["x", "y"]].to_numpy() == pytest.approx(log[["x", "y"]].to_numpy(), abs=1e-9)
    assert off(back["yaw"], log["yaw"]).max() < 1e-9


def test_a_shifted_frame_is_two_metres_away_and_a_short_metre_gives_more_of_them() -> None:
    log = line()
    shifted, scaled = (changed(CONDITIONS[name].change, log) for name in ("shifted", "scaled"))
    assert (shifted["x"] - log["x"]).to_numpy() == pytest.approx(2.0)
    assert (shifted["y"] == log["y"]).all()
    assert (shifted["yaw"] == log["yaw"]).all()
    assert scaled[["x", "y"]].to_numpy() == pytest.approx(1.01 * log[["x", "y"]].to_numpy())
    assert (scaled["yaw"] == log["yaw"]).all()


def test_the_first_ten_seconds_are_250_rows_of_each_robot() -> None:
    after = changed(CONDITIONS["seconds-10"].change)
    assert after.groupby("robot").size().tolist() == [250] * 3


def columns(name: str) -> set[str]:
    return set(line()) - set(changed(CONDITIONS[name].change))


def test_columns_that_a_lab_lacks_are_gone() -> None:
    assert columns("no-sensors") == {"ps0", "ls0", "food", "nest"}
    assert columns("no-encoders") == {"wheel_left", "wheel_right"}
    assert columns("no-yaw") == {"yaw"}
    assert columns("as-recorded") == set()


def test_half_of_the_robots_are_those_with_even_numbers() -> None:
    after = changed(CONDITIONS["half-unlogged"].change, line(robots=5))
    assert after["robot"].unique().tolist() == [0, 2, 4]


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of eight seconds."""
    monkeypatch.setattr(matrix, "SECONDS", 8.0)


def test_a_diagnosis_is_given_a_log_that_does_not_say_what_recorded_it(
    short: None, tmp_path: Path
) -> None:
    names = ("as-recorded", "rate-20", "arena-0.5", "build-1")
    cells = plan(matrix_config(trials=1, conditions=names))[: len(names)]
    for cell in cells:
        room = tmp_path / cell.name
        room.mkdir()
        write_given(cell, room)
        model = {"extended.toml"} if cell.condition == "arena-0.5" else set()
        files = {path.name for path in room.iterdir()} - {"epuck.npz"}
        assert files == {"samples.parquet", *model}
        assert RECORDER not in pq.read_schema(room / "samples.parquet").metadata
        told = Model.load(room / "extended.toml" if model else None)
        assert told.point().arena_radius == (0.5 if model else 0.6)
        log = read_log(room / "samples.parquet", model=told).measured
        assert log.recorder == ""
        assert set(log.robots) == set(range(10))
        assert {str(one) for one in pd.read_parquet(room / "samples.parquet")["run"]} == {"log"}

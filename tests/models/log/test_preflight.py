"""What a log says of itself is what was done to it."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.gap.replay import replay_log
from realitygap.models.log.measured import MeasuredLog, make_log
from realitygap.models.log.noise import PoseNoise, pose_noise
from realitygap.models.log.preflight.colour import Correlation, colour
from realitygap.models.log.preflight.poses import facing, failures, step_of, steps_of
from realitygap.models.log.preflight.stamps import commands, stamps
from tests.models.small import arena_log, driven_log

POSE = ["x", "y", "yaw"]
NOISE = PoseNoise(5e-4, 5e-3)
DRIVE = Drive()


def log_of(frame: pd.DataFrame) -> MeasuredLog:
    return make_log(frame, drive=DRIVE)


def noisy(seed: int = 3, robots: int = 3, rows: int = 1500) -> pd.DataFrame:
    return driven_log(
        seed,
        robots=robots,
        rows=rows,
        position_noise=NOISE.position,
        heading_noise=NOISE.heading,
    )


def with_noise(noise: FloatArray, seed: int = 3) -> pd.DataFrame:
    """Three robots' log with (rows, 3) noise each, of unit variance."""
    frame = driven_log(seed, rows=len(noise) // 3, robots=3)
    frame[POSE] += noise * [NOISE.position, NOISE.position, NOISE.heading]
    return frame


def averages(over: int, rows: int = 4500) -> FloatArray:
    """(rows, 3) averages of white noise over so many rows."""
    white = np.random.default_rng(np.random.SeedSequence(7)).normal(size=(rows + over, 3))
    total = np.cumsum(white, axis=0)
    return np.asarray((total[over:] - total[:-over]) / over)


def colours(frame: pd.DataFrame) -> tuple[Correlation, Correlation]:
    log = log_of(frame)
    position, heading = colour(log, replay_log(log, DRIVE))
    assert position is not None
    assert heading is not None
    return position, heading


def test_jitter_of_stamps_is_measured_and_even_stamps_have_none() -> None:
    rng = np.random.default_rng(np.random.SeedSequence(1))
    frame = noisy()
    assert stamps(log_of(frame)).jitter == 0.0
    late = frame.assign(t=frame["t"] + rng.normal(0.0, 0.005, len(frame)))
    assert stamps(log_of(late)).jitter == pytest.approx(0.005, rel=0.05)
    # rows that are missing are a gap or two, and no jitter
    fewer = frame[~frame["t"].between(10.0, 12.0) & (frame.index % 7 != 0)]
    found = stamps(log_of(fewer))
    assert found.jitter == 0.0
    assert found.gaps == 3


def test_rounded_stamps_jitter_by_the_rounding() -> None:
    frame = noisy()
    third = frame.assign(t=np.round(frame["t"] / 0.04 / 30.0, 3))
    assert stamps(log_of(third)).jitter == pytest.approx(1e-3 / np.sqrt(12.0), rel=0.2)


def test_rates_of_rows_and_of_poses_are_told_apart() -> None:
    frame = noisy()
    found = stamps(log_of(frame))
    assert (found.row_rate, found.pose_rate) == pytest.approx((25.0, 25.0))
    assert (found.repeats, found.without, found.gaps) == (0.0, 0.0, 0)
    frame.loc[frame.index % 5 != 0, POSE] = np.nan
    found = stamps(log_of(frame))
    assert (found.row_rate, found.pose_rate) == pytest.approx((25.0, 5.0))
    assert found.without == pytest.approx(0.8)


@pytest.mark.parametrize("every", [1, 2, 5])
def test_held_poses_are_counted_whether_or_not_they_are_repaired(every: int) -> None:
    frame = noisy()
    frame[POSE] = frame[POSE].iloc[np.arange(len(frame)) // every * every].to_numpy()
    found = stamps(log_of(frame))
    assert found.repeats == pytest.approx(1.0 - 1.0 / every, abs=1e-9)
    assert found.pose_rate == pytest.approx(25.0 / every)
    assert found.without == 0.0
    few = noisy()
    few.loc[10::100, POSE] = few.loc[9::100, POSE].to_numpy()
    log = log_of(few)
    assert not log.held.any()
    assert stamps(log).repeats == pytest.approx(0.01)


def test_commands_that_change_in_every_row_are_told_from_those_that_hold() -> None:
    frame = noisy()  # a new command every 20 rows
    held = commands(log_of(frame))
    assert held.rate == pytest.approx(25.0 / 20.0, rel=0.02)
    assert held.together == 0.0
    seen = commands(log_of(frame[frame.index % 20 == 0]))
    assert seen.together == 1.0
    steady = frame.assign(cmd_left=3.0, cmd_right=3.0)
    assert commands(log_of(steady)).together is None


@pytest.mark.parametrize(("over", "value"), [(1, 0.0), (2, 1 / 2), (3, 2 / 3), (4, 3 / 4)])
def test_the_noise_of_averages_hangs_together_as_averages_do(over: int, value: float) -> None:
    for found in colours(with_noise(averages(over))):
        assert found.low < value < found.high
        assert found.high - found.low < 0.4
        assert found.value == pytest.approx(value, abs=0.1)


def test_interpolated_poses_show_in_their_noise() -> None:
    noise = averages(1)
    noise[1:-1:2] = 0.5 * (noise[:-2:2] + noise[2::2])
    for found in colours(with_noise(noise)):
        assert found.value == pytest.approx(2 / 3, abs=0.1)


def test_the_colour_is_the_trackers_whatever_is_wrong_with_a_robot() -> None:
    frame = driven_log(
        3,
        robots=3,
        rows=1500,
        drive=Drive(wheel_radius=(0.0200, 0.0210), time_constant=0.05),
        position_noise=NOISE.position,
        heading_noise=NOISE.heading,
    )
    frame.loc[50::60, ["x", "y"]] += 0.1  # a tracker's failures
    for found in colours(frame):
        assert found.value == pytest.approx(0.0, abs=0.15)


def test_without_commands_that_hold_nobody_knows_the_colour() -> None:
    frame = noisy()
    rng = np.random.default_rng(np.random.SeedSequence(5))
    frame[["cmd_left", "cmd_right"]] += rng.normal(0.0, 1e-3, (len(frame), 2))
    log = log_of(frame)
    assert colour(log, replay_log(log, DRIVE)) == (None, None)


@pytest.mark.parametrize("single", [False, True])
def test_steps_of_poses_are_found_and_smooth_ones_have_none(single: bool) -> None:
    frame = noisy()
    kind = np.float32 if single else np.float64
    assert steps_of(log_of(frame.astype(dict.fromkeys(POSE, kind)))) == (None, None)
    degree = np.pi / 180.0
    rounded = frame.assign(
        x=frame["x"].round(3), y=frame["y"].round(3), yaw=(frame["yaw"] / degree).round() * degree
    ).astype(dict.fromkeys(POSE, kind))
    assert steps_of(log_of(rounded)) == pytest.approx((1e-3, degree), rel=1e-4)


def test_a_value_alone_has_no_step() -> None:
    assert step_of(np.full(5, 0.3)) is None
    assert step_of(np.full(5, np.nan)) is None


def test_failures_of_the_tracker_are_counted() -> None:
    frame = noisy()
    assert failures(log_of(frame), NOISE, None)[:2] == (0.0, None)
    frame.loc[30::50, "x"] += 0.3
    assert failures(log_of(frame), NOISE, None).outliers == pytest.approx(0.02, abs=1e-3)


def test_poses_beyond_the_believed_wall_are_counted() -> None:
    log = log_of(arena_log())
    far = np.hypot(*log.poses[:, :2].T)
    assert failures(log, NOISE, 0.6).beyond == 0.0
    found = failures(log, NOISE, 0.4)
    assert found.beyond == pytest.approx(np.mean(far > 0.4), abs=0.01)
    assert found.beyond is not None
    assert found.beyond > 0.02
    assert found.furthest == far.max()


@pytest.mark.parametrize(
    ("change", "like", "offset"),
    [
        (lambda yaw: yaw, "yaw", 0.0),
        (lambda yaw: yaw + 0.3, "yaw", -0.3),
        (lambda yaw: np.degrees(yaw), "degrees", None),
        (lambda yaw: -yaw, "clockwise", None),
        (lambda yaw: np.sin(0.5 * yaw), "quaternion z", None),
    ],
)
def test_a_yaw_that_is_none_shows_beside_the_motion(
    change: object, like: str, offset: float | None
) -> None:
    assert callable(change)
    log = log_of(noisy())
    wrapped = (log.frame["yaw"] + np.pi) % (2.0 * np.pi) - np.pi
    log.frame["yaw"] = change(wrapped)  # a reader would refuse most of them
    found = facing(log, NOISE, DRIVE)
    assert found is not None
    assert found.like == like
    if offset is None:
        assert found.apart > 0.3
    else:
        assert found.apart == 0.0
        assert found.offset == pytest.approx(offset, abs=0.01)


def test_robots_that_stand_face_nowhere() -> None:
    frame = noisy().assign(cmd_left=0.0, cmd_right=0.0)
    frame[POSE] = np.random.default_rng(np.random.SeedSequence(2)).normal(
        0.0, NOISE.position, (len(frame), 3)
    )
    assert facing(log_of(frame), NOISE, DRIVE) is None


def test_the_noise_is_that_of_the_tracker() -> None:
    log = log_of(noisy())
    assert pose_noise(log, replay_log(log, DRIVE)) == pytest.approx(NOISE, rel=0.1)

"""The drive of the point model against the analytic truth of two wheels."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import Diverged, Drive, InputError, replay

speeds = st.floats(-7.0, 7.0)


def one_segment(commands: np.ndarray, drive: Drive, step: float = 0.04) -> np.ndarray:
    rows = len(commands)
    return replay(np.arange(rows) * step, commands, [0, rows], [[0, 0, 0]], drive=drive).poses


def test_a_robot_driven_with_equal_wheels_goes_straight() -> None:
    path = one_segment(np.full((51, 2), 5.0), Drive())
    assert path[-1] == pytest.approx([5.0 * 0.0205 * 2.0, 0.0, 0.0], abs=1e-12)


def test_a_robot_with_one_faster_wheel_drives_a_circle_of_the_known_radius() -> None:
    drive = Drive()
    left, right = 3.0, 5.0
    radius = 0.5 * drive.axle * (right + left) / (right - left)
    path = one_segment(np.tile([left, right], (400, 1)), drive)
    assert np.hypot(path[:, 0], path[:, 1] - radius) == pytest.approx(radius, rel=1e-9)


def test_opposite_wheels_spin_on_the_spot() -> None:
    drive = Drive()
    path = one_segment(np.tile([-4.0, 4.0], (26, 1)), drive)
    assert np.abs(path[:, :2]).max() < 1e-12
    assert path[-1, 2] == pytest.approx(2 * 4.0 * 0.0205 / drive.axle * 1.0, rel=1e-12)


@given(left=speeds, right=speeds, pieces=st.integers(1, 40))
def test_cutting_an_interval_into_pieces_changes_nothing(
    left: float, right: float, pieces: int
) -> None:
    whole = one_segment(np.tile([left, right], (2, 1)), Drive(), step=1.0)[-1]
    cut = one_segment(np.tile([left, right], (pieces + 1, 1)), Drive(), step=1.0 / pieces)[-1]
    assert cut == pytest.approx(whole, abs=1e-10)


@given(
    x=st.floats(-1, 1),
    y=st.floats(-1, 1),
    yaw=st.floats(-math.pi, math.pi),
    left=speeds,
    right=speeds,
)
def test_motion_does_not_depend_on_where_it_starts(
    x: float, y: float, yaw: float, left: float, right: float
) -> None:
    t, commands = [0.0, 0.5, 1.0], [[left, right], [right, left], [0, 0]]
    home = replay(t, commands, [0, 3], [[0, 0, 0]], drive=Drive()).poses[-1]
    away = replay(t, commands, [0, 3], [[x, y, yaw]], drive=Drive()).poses[-1]
    c, s = math.cos(yaw), math.sin(yaw)
    expected = [x + c * home[0] - s * home[1], y + s * home[0] + c * home[1], yaw + home[2]]
    assert away == pytest.approx(expected, abs=1e-10)


def test_latency_delays_the_motion_by_its_length_at_any_fraction_of_a_step() -> None:
    commands = np.full((26, 2), 5.0)
    path = one_segment(commands, Drive(latency=0.11))
    assert path[-1, 0] == pytest.approx(5.0 * 0.0205 * (1.0 - 0.11), rel=1e-12)


def test_a_lagging_motor_loses_its_time_constant_of_motion() -> None:
    tau = 0.08
    path = one_segment(np.full((51, 2), 5.0), Drive(time_constant=tau))
    lost = tau * (1.0 - math.exp(-2.0 / tau))
    assert path[-1, 0] == pytest.approx(5.0 * 0.0205 * (2.0 - lost), rel=1e-12)


def test_an_acceleration_limit_costs_half_the_speed_squared_over_it() -> None:
    path = one_segment(np.full((51, 2), 5.0), Drive(acceleration=(100.0, 100.0)))
    assert path[-1, 0] == pytest.approx(0.0205 * (5.0 * 2.0 - 0.5 * 25.0 / 100.0), rel=1e-12)


def test_saturation_dead_zone_and_droop_do_what_their_names_say() -> None:
    fast = np.full((26, 2), 6.0)
    assert one_segment(fast, Drive(speed_limit=(5.0, 5.0)))[-1, 0] == pytest.approx(0.0205 * 5.0)
    assert one_segment(fast, Drive(dead_zone=(6.5, 6.5)))[-1, 0] == 0.0
    drooped = one_segment(np.full((3001, 2), 6.0), Drive(droop_rate=0.001))
    assert np.diff(drooped[:, 0])[-1] == pytest.approx(0.0205 * 6.0 * 0.04 * 0.88, rel=1e-3)


def test_a_wheel_waits_before_it_starts_and_before_it_turns_the_other_way_and_never_else() -> None:
    told = [0.0] * 10 + [5.0] * 30 + [3.0] * 20 + [-4.0] * 25 + [0.0] * 2 + [-4.0] * 14 + [0.0]
    path = one_segment(np.tile(np.array(told)[:, None], (1, 2)), Drive(start_delay=0.11))
    turned = 5.0 * (1.2 - 0.11) + 3.0 * 0.8 - 4.0 * (1.0 - 0.11) - 4.0 * (0.56 - 0.11)
    assert path[-1, 0] == pytest.approx(0.0205 * turned, rel=1e-12)
    assert path[12, 0] == 0.0  # 80 ms after the first command
    assert path[13, 0] == pytest.approx(0.0205 * 5.0 * 0.01, rel=1e-9)


def test_a_moving_wheel_that_waits_is_braked_by_its_motor() -> None:
    told, lag = np.array([5.0] * 50 + [-5.0] * 51), 0.05
    drive = Drive(start_delay=0.3, time_constant=lag)
    path = one_segment(np.tile(told[:, None], (1, 2)), drive)[:, 0]
    assert path[57] - path[50] == pytest.approx(0.0205 * 5.0 * lag * (1.0 - math.exp(-5.6)))
    assert np.diff(path)[-1] == pytest.approx(-0.0205 * 5.0 * 0.04)


CURVE = ((-6.0, -5.0), (-1.0, 0.0), (1.0, 0.0), (5.0, 4.5))


@given(told=st.floats(-9.0, 9.0))
def test_a_wheel_does_what_its_curve_says_and_the_other_as_told(told: float) -> None:
    drive = Drive(done_curve=(CURVE, ()))
    path = replay([0.0, 0.04], [[told, told]] * 2, [0, 2], [[0, 0, 0]], drive=drive).poses[-1]
    done = float(np.interp(told, *np.array(CURVE).T))
    assert path[2] == pytest.approx(0.0205 * (told - done) * 0.04 / drive.axle, abs=1e-12)


def test_a_dead_zone_and_a_limit_are_shapes_of_a_curve() -> None:
    told = np.random.default_rng(3).uniform(-7.0, 7.0, (200, 2))
    told[np.abs(np.abs(told) - 1.0) < 1e-3] = 2.0
    edge = 1.0 - 1e-6
    shape = ((-5.0, -5.0), (-1.0, -1.0), (-edge, 0.0), (edge, 0.0), (1.0, 1.0), (5.0, 5.0))
    curved = one_segment(told, Drive(done_curve=(shape, shape)))
    plain = one_segment(told, Drive(dead_zone=(1.0, 1.0), speed_limit=(5.0, 5.0)))
    assert curved == pytest.approx(plain, abs=1e-12)


@pytest.mark.parametrize(
    ("curve", "said"),
    [
        (((1.0, 1.0),), r"done_curve knots\[0\]: got 1"),
        (tuple((float(k), float(k)) for k in range(9)), "done_curve knots: got 9"),
        (((0.0, 0.0), (0.0, 1.0)), r"done_curve told\[1\]: got 0"),
        (((0.0, 1.0), (1.0, 0.0)), r"done_curve done\[1\]: got -1"),
        (((0.0, 1.0), (math.inf, 2.0)), r"done_curve told\[1\]: got inf"),
    ],
)
def test_a_curve_that_is_none_is_refused(curve: tuple[tuple[float, float], ...], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Drive(done_curve=(curve, ())).struct()


@given(left=speeds, right=speeds, most=st.floats(0.1, 7.0))
def test_a_robot_that_turns_first_gives_up_speed_and_keeps_its_turn_rate(
    left: float, right: float, most: float
) -> None:
    told = one_segment(np.tile([left, right], (2, 1)), Drive())[-1]
    done = one_segment(np.tile([left, right], (2, 1)), Drive(turn_first=most))[-1]
    forward = 0.5 * (left + right)
    turn = 0.5 * (right - left)
    room = max(most - abs(turn), 0.0)
    turned = math.copysign(min(abs(turn), most), turn)
    assert done[2] == pytest.approx(2.0 * 0.0205 * turned * 0.04 / Drive().axle, abs=1e-12)
    kept = math.copysign(min(abs(forward), room), forward)
    chord = 0.0205 * kept * 0.04 * np.sinc(0.5 * done[2] / np.pi)
    assert math.hypot(*done[:2]) == pytest.approx(abs(chord), abs=1e-12)
    if max(abs(left), abs(right)) <= most:
        assert done.tobytes() == told.tobytes()


@given(st.lists(st.tuples(speeds, speeds), min_size=2, max_size=30))
def test_the_null_is_the_minimal_model_to_the_last_bits(
    commands: list[tuple[float, float]],
) -> None:
    """Against two-wheel kinematics written down here, without any of the terms."""
    drive, step = Drive(), 0.04
    pose, expected = np.zeros(3), [np.zeros(3)]
    for left, right in commands[:-1]:
        forward = 0.5 * 0.0205 * (left + right) * step
        turn = 0.0205 * (right - left) * step / drive.axle
        chord = forward * np.sinc(0.5 * turn / np.pi)
        middle = pose[2] + 0.5 * turn
        pose = pose + np.array([chord * np.cos(middle), chord * np.sin(middle), turn])
        expected.append(pose)
    assert one_segment(np.array(commands), drive) == pytest.approx(np.array(expected), abs=1e-14)


def test_wheels_stand_still_when_the_battery_is_empty() -> None:
    path = one_segment(np.full((501, 2), 5.0), Drive(droop_rate=0.1))
    assert np.diff(path[:, 0]).min() >= 0.0
    assert np.diff(path[260:, 0]).max() == 0.0  # from 10 s on


def test_a_battery_is_as_old_as_the_log_whatever_its_clock_says() -> None:
    t, commands = np.arange(100) * 0.04, np.full((100, 2), 5.0)
    drive = Drive(droop_rate=0.05)
    paths = [replay(t + at, commands, [0, 100], [[0, 0, 0]], drive=drive).poses for at in (0, 1e3)]
    np.testing.assert_allclose(*paths, atol=1e-9)


def test_segments_are_replayed_apart() -> None:
    t = [0.0, 1.0, 0.0, 1.0]
    commands = [[1, 1], [1, 1], [2, 2], [2, 2]]
    poses = replay(t, commands, [0, 2, 4], [[0, 0, 0], [5, 0, 0]], drive=Drive()).poses
    assert poses[1, 0] == pytest.approx(0.0205)
    assert poses[3, 0] == pytest.approx(5 + 2 * 0.0205)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"commands": [[1, 1], [math.nan, 1], [1, 1]]}, r"commands\[1\]: got nan"),
        ({"commands": [[1, 1], [1, 1], [1, math.inf]]}, r"commands\[2\]: got inf"),
        ({"t": [0.0, math.nan, 2.0]}, r"t\[1\]: got nan"),
        ({"t": [0.0, 1.0, 0.5]}, r"t\[2\]: got 0.5, expected a finite number from 1"),
        ({"initial": [[0.0, math.inf, 0.0]]}, r"initial\[0\]: got inf"),
        ({"start": [0, 2, 1, 3]}, r"start\[2\]: got 1"),
        ({"start": []}, "start: got nothing"),
        ({"t": 3.0}, "t: got shape"),
    ],
)
def test_a_number_that_cannot_be_used_is_refused_by_its_name_and_row(
    change: dict[str, object], says: str
) -> None:
    good = {"t": [0, 1, 2], "commands": [[1, 1]] * 3, "start": [0, 3], "initial": [[0, 0, 0]]}
    if len(np.atleast_1d(change.get("start", []))) == 4:
        good["initial"] = [[0, 0, 0]] * 3
    with pytest.raises(InputError, match=says):
        replay(**{**good, **change}, drive=Drive())


def test_commands_that_lead_out_of_the_finite_numbers_are_an_error_that_names_the_row() -> None:
    with pytest.raises(Diverged, match="poses 2"):
        replay([0, 1, 2], [[1, 1], [1e308, -1e308], [1, 1]], [0, 3], [[0, 0, 0]], drive=Drive())


@pytest.mark.parametrize(
    "change",
    [{"commands": [[1, 1]]}, {"start": [0, 2]}, {"start": [1, 3]}, {"initial": [[0, 0]]}],
)
def test_shapes_that_disagree_are_refused(change: dict[str, object]) -> None:
    good = {"t": [0, 1, 2], "commands": [[1, 1]] * 3, "start": [0, 3], "initial": [[0, 0, 0]]}
    with pytest.raises(ValueError, match=next(iter(change))):
        replay(**{**good, **change}, drive=Drive())


def test_wheels_that_roll_as_a_log_begins_keep_their_speed_until_a_command_arrives() -> None:
    drive = Drive(latency=0.3)
    t, told = np.arange(21) * 0.05, np.zeros((21, 2))
    rolling = replay(t, told, [0, 21], [[0, 0, 0]], drive=drive, rolling=[[4.0, 4.0]]).poses
    assert rolling[-1, 0] == pytest.approx(0.3 * 4.0 * 0.0205, rel=1e-12)


@given(speed=speeds, lag=st.floats(0.05, 2.0))
def test_rolling_wheels_decay_with_the_motors_lag(speed: float, lag: float) -> None:
    drive = Drive(time_constant=lag)
    t, told = np.arange(41) * 0.05, np.zeros((41, 2))
    made = replay(t, told, [0, 41], [[0, 0, 0]], drive=drive, rolling=[[speed, speed]])
    assert made.speeds[:, 0] == pytest.approx(speed * np.exp(-t / lag), rel=1e-9, abs=1e-12)


def test_a_log_that_begins_at_rest_is_the_same_to_the_bit() -> None:
    t, told = np.arange(50) * 0.04, np.random.default_rng(1).uniform(-5, 5, (50, 2))
    drive = Drive(latency=0.1, time_constant=0.2)
    still = replay(t, told, [0, 50], [[0, 0, 0]], drive=drive, rolling=np.zeros((1, 2)))
    assert (still.poses == replay(t, told, [0, 50], [[0, 0, 0]], drive=drive).poses).all()


def test_a_rolling_speed_that_is_no_number_is_refused() -> None:
    with pytest.raises(InputError, match=r"rolling\[1\]"):
        replay(
            np.arange(4.0),
            np.ones((4, 2)),
            [0, 2, 4],
            np.zeros((2, 3)),
            drive=Drive(),
            rolling=[[0.0, 0.0], [0.0, np.nan]],
        )

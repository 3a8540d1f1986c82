"""The rigid-body e-puck against the analytic truth of two wheels, and against itself turned."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.reality import constants as k
from realitygap.reality.engine import EngineName
from realitygap.studies.measure.convergence import (
    CHOSEN,
    FINER,
    WRONG,
    converged,
    drive,
    manoeuvres,
    misses,
    second_by_second,
)

FULL = 6.0
"""rad/s."""
START_UP = 0.03
"""s of motion lost while the motors, of finite torque, come up to speed: a bound."""


def steady(engine: EngineName, left: float, right: float, seconds: float = 2.0) -> np.ndarray:
    """Paths (12, steps, 3) at twelve headings after the start-up, each in its own frame."""
    path = drive(
        [(10, left, right), (round(seconds / k.CONTROL_STEP), left, right)], CHOSEN[engine]
    )
    path = path[:, 10:]
    c, s = np.cos(path[:, :1, 2]), np.sin(path[:, :1, 2])
    dx, dy = path[..., 0] - path[:, :1, 0], path[..., 1] - path[:, :1, 1]
    yaw = path[..., 2] - path[:, :1, 2]
    return np.stack([c * dx + s * dy, c * dy - s * dx, yaw], axis=2)


def test_equal_wheels_drive_straight_at_their_rims_speed(engine: EngineName) -> None:
    path = steady(engine, FULL, FULL)
    assert path[:, -1, 0] == pytest.approx(FULL * k.WHEEL_RADIUS * 2.0, rel=2e-3)
    assert np.abs(path[:, -1, 1]).max() < 1.5e-3
    assert np.abs(path[:, -1, 2]).max() < 5e-3


@pytest.mark.parametrize(("left", "right"), [(3.0, 6.0), (6.0, 4.5), (0.0, 5.0)])
def test_unequal_wheels_drive_a_circle_of_the_known_radius(
    engine: EngineName, left: float, right: float
) -> None:
    path = steady(engine, left, right)
    length = 0.5 * (left + right) * k.WHEEL_RADIUS * 2.0
    turn = path[:, -1, 2]
    radius = 0.5 * k.AXLE * (right + left) / (right - left)
    assert length / turn == pytest.approx(radius, rel=5e-3)
    centre = np.abs(np.hypot(path[..., 0], path[..., 1] - radius) - abs(radius))
    assert centre.max() < 2e-3


def test_opposite_wheels_spin_on_the_spot(engine: EngineName) -> None:
    path = steady(engine, -4.0, 4.0)
    assert np.hypot(path[..., 0], path[..., 1]).max() < 1e-3
    rate = 2.0 * 4.0 * k.WHEEL_RADIUS / k.AXLE
    assert path[:, -1, 2] == pytest.approx(rate * 2.0, rel=3e-3)


def test_a_robot_stops_within_its_braking_distance(engine: EngineName) -> None:
    path = drive([(25, FULL, FULL), (25, 0.0, 0.0)], CHOSEN[engine])
    braking = (FULL * k.WHEEL_RADIUS) ** 2 / (2.0 * 2.0 * k.MOTOR_TORQUE / k.WHEEL_RADIUS / k.MASS)
    rolled = path[:, -1, 0] - path[:, 25, 0]
    assert (rolled > 0.5 * braking).all()
    assert (rolled < 2.0 * braking).all()
    assert np.ptp(path[:, 35:, 0], axis=1).max() < 5e-4  # and stays where it is


def test_motion_starts_late_by_the_motors_finite_torque_and_no_more(engine: EngineName) -> None:
    path = drive([(25, FULL, FULL)], CHOSEN[engine])
    late = 1.0 - path[:, -1, 0] / (FULL * k.WHEEL_RADIUS)
    assert (late > 0.0).all()
    assert (late < START_UP).all()


@pytest.mark.parametrize(
    "commands",
    [[(50, FULL, FULL)], [(50, 3.0, FULL)], [(50, -4.0, 4.0)], [(25, FULL, FULL), (25, 0.0, 0.0)]],
    ids=["straight", "arc", "spin", "stop"],
)
def test_the_same_commands_at_twelve_headings_agree(
    engine: EngineName,
    commands: list[tuple[int, float, float]],
) -> None:
    """Isotropy: the engine's friction depends on heading; over 2 s by at most 1.5 mm, 10 mrad."""
    end = drive(commands, CHOSEN[engine])[:, -1]
    spread = np.ptp(end, axis=0)
    assert spread[:2].max() < 1.5e-3
    assert spread[2] < 1e-2


def test_half_the_step_and_ten_times_the_iterations_agree_to_a_millimetre_a_second(
    engine: EngineName,
) -> None:
    commands = [(25, FULL, FULL), (15, -4.0, 4.0), (20, 2.0, 6.0), (15, 0.0, 0.0), (25, 6.0, 5.0)]
    chosen = drive(commands, CHOSEN[engine], 4)
    finer = drive(commands, FINER[engine], 4)
    position, heading = second_by_second(chosen, finer)
    assert position < 1e-3
    assert heading < 1e-2


def test_manoeuvres_are_converged_and_a_setting_that_is_fast_and_wrong_is_caught(
    engine: EngineName,
) -> None:
    finer = manoeuvres(FINER[engine])
    assert converged(misses(CHOSEN[engine], finer))
    assert not any(converged(misses(wrong, finer)) for wrong in WRONG[engine])


def test_two_worlds_move_bit_for_bit_alike(engine: EngineName) -> None:
    commands = [(20, 6.0, 2.0), (20, -4.0, 4.0)]
    assert (drive(commands, CHOSEN[engine], 3) == drive(commands, CHOSEN[engine], 3)).all()

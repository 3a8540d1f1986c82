"""Every motion effect changes the motion as its physics says, and nothing else."""

from __future__ import annotations

import math

import numpy as np
import pytest

from realitygap.reality import constants as k
from realitygap.reality.engine import EngineName
from tests.reality.hidden import FULL, SPEED, drive, rest, spin, straight

pytestmark = pytest.mark.usefixtures("engine")


def lag_of_second(spec: str, seconds: float = 1.0) -> float:
    """s by which the second robot trails the first on a straight, once both stand settled."""
    path = drive(lambda step: (0.0, 0.0) if step < 5 else straight(step), 0.2 + seconds, spec)
    return float(path.ahead[-1, 0] - path.ahead[-1, 1]) / SPEED


def speed_ratio(spec: str) -> float:
    path = drive(straight, 2.0, spec)
    run = path.ahead[-1] - path.ahead[25]
    return float(run[1] / run[0])


@pytest.mark.parametrize("ratio", [1.05, 0.9])
def test_wheels_of_different_radius_drive_a_circle(ratio: float) -> None:
    path = drive(straight, 2.0, f"wheel_radius_mismatch:ratio={ratio},robot=1")
    way = np.hypot(*np.diff(path.true[25:, 1, :2], axis=0).T).sum()
    curvature = (path.turned[-1, 1] - path.turned[25, 1]) / way
    assert curvature == pytest.approx(2.0 * (ratio - 1.0) / (ratio + 1.0) / k.AXLE, rel=0.02)


@pytest.mark.parametrize("scale", [0.9, 1.1])
def test_larger_wheels_drive_faster_in_proportion(scale: float) -> None:
    assert speed_ratio(f"wheel_radius_scale:scale={scale},robot=1") == pytest.approx(
        scale, rel=2e-3
    )


@pytest.mark.parametrize("scale", [0.9, 1.1])
def test_wheels_further_apart_spin_the_body_slower_in_proportion(scale: float) -> None:
    path = drive(spin, 2.0, f"wheel_separation:scale={scale},robot=1")
    turned = path.turned[-1] - path.turned[25]
    assert turned[0] / turned[1] == pytest.approx(scale, rel=3e-3)


@pytest.mark.parametrize("seconds", [0.004, 0.010, 0.027, 0.040, 0.105, 0.3])
def test_latency_delays_the_motion_by_what_it_says_below_the_physics_step_too(
    seconds: float,
) -> None:
    measured = lag_of_second(f"command_latency:seconds={seconds},robot=1")
    assert measured == pytest.approx(seconds, abs=2e-3)


def test_a_delayed_command_is_late_and_not_lost() -> None:
    path = drive(lambda step: (FULL, FULL) if step < 2 else (0.0, 0.0), 1.0,
                 "command_latency:seconds=0.2,robot=1")  # fmt: skip
    assert path.ahead[5, 1] < 3e-4  # a robot at rest settles this much
    assert path.ahead[-1, 1] == pytest.approx(path.ahead[-1, 0], rel=0.03)


@pytest.mark.parametrize("time_constant", [0.1, 0.2])
def test_a_lagging_motor_approaches_its_speed_exponentially(time_constant: float) -> None:
    path = drive(straight, 1.0, f"motor_lag:time_constant={time_constant},robot=1")
    t = 0.04 * np.arange(26)
    expected = SPEED * (t - time_constant * (1.0 - np.exp(-t / time_constant)))
    assert np.abs(path.ahead[:, 1] - expected).max() < 1e-3


@pytest.mark.parametrize("torque", [0.003, 0.001])
def test_a_weak_motor_accelerates_with_its_torque(engine: EngineName, torque: float) -> None:
    path = drive(
        lambda step: (0.0, 0.0) if step < 5 else straight(step),
        0.24,
        f"weak_motor:torque={torque},robot=1",
    )
    # pybullet's poses are those of a step's end, each step at the speed it ends with
    ahead = k.PHYSICS_STEP if engine == "pybullet" else 0.0
    way = path.ahead[6, 1] - path.ahead[5, 1]  # settled on its skid
    acceleration = 2.0 * way / (k.CONTROL_STEP * (k.CONTROL_STEP + ahead))
    force = 2.0 * torque / k.WHEEL_RADIUS
    rolling = k.MASS + 2.0 * k.WHEEL_INERTIA / k.WHEEL_RADIUS**2
    assert acceleration == pytest.approx(force / rolling, rel=0.08)


@pytest.mark.parametrize("friction", [0.05, 0.1])
def test_wheels_that_slip_accelerate_with_their_friction(friction: float) -> None:
    # In the first 40 ms the motors, which run up their rotors, press the wheels on the floor.
    path = drive(straight, 0.12, f"low_friction:friction={friction},robot=1")
    acceleration = np.diff(path.ahead[1:4, 1], 2)[0] / k.CONTROL_STEP**2
    assert acceleration == pytest.approx(slipping(friction), rel=0.03)


@pytest.mark.parametrize("friction", [0.05, 0.1])
def test_locked_wheels_stop_a_robot_by_their_friction(friction: float) -> None:
    path = drive(
        lambda step: straight(step) if step < 25 else (0.0, 0.0),
        1.2,
        f"low_friction:friction={friction},robot=1",
    )
    deceleration = -np.diff(path.ahead[26:, 1], 2)[0] / k.CONTROL_STEP**2
    assert deceleration == pytest.approx(-slipping(-friction), rel=0.03)


def slipping(friction: float) -> float:
    """m/s^2 of a robot whose wheels slip, forward: friction times the weight that they carry.

    What is pushed at the floor tips back, off the skid.
    """
    masses = np.array([k.MASS - 2.0 * k.WHEEL_MASS - k.SKID_MASS, 2.0 * k.WHEEL_MASS, k.SKID_MASS])
    ahead = masses @ [k.CENTRE_OF_MASS[0], 0.0, k.SKID] / k.MASS
    height = masses @ [k.CENTRE_OF_MASS[2], k.WHEEL_RADIUS, k.SKID_RADIUS] / k.MASS
    return float(friction * k.GRAVITY * (1.0 - ahead / k.SKID) / (1.0 - friction * height / k.SKID))


def test_encoders_tell_a_slipping_wheel_from_a_weak_motor() -> None:
    slipping = drive(straight, 0.2, "low_friction:friction=0.05,robot=1")
    weak = drive(straight, 0.2, "weak_motor:torque=0.0005,robot=1")
    assert slipping.encoders[3, 1].mean() > 0.9 * FULL
    assert weak.encoders[3, 1].mean() < 0.5 * FULL


@pytest.mark.parametrize(("wheel", "sides"), [("left", (0,)), ("right", (1,)), ("both", (0, 1))])
def test_a_saturated_wheel_turns_at_its_limit(wheel: str, sides: tuple[int, ...]) -> None:
    path = drive(straight, 1.0, f"motor_saturation:limit=4.0,wheel={wheel},robot=1")
    speeds = path.encoders[10:, 1].mean(axis=0)
    expected = [4.0 if side in sides else FULL for side in range(2)]
    assert speeds == pytest.approx(expected, abs=0.05)


def test_a_robot_that_turns_first_slows_down_and_turns_as_told() -> None:
    path = drive(lambda step: (3.0, FULL), 1.5, "turn_first:limit=4.0,robot=1")
    assert path.encoders[20:, 1].mean(axis=0) == pytest.approx([1.0, 4.0], abs=0.05)
    turned = path.turned[-1] - path.turned[20]
    assert turned[1] == pytest.approx(turned[0], rel=0.01)


def test_a_robot_that_turns_first_and_is_told_no_more_does_as_told() -> None:
    same = drive(spin, 0.4, "turn_first:limit=4.0,robot=1")
    assert same.encoders[5:, 1].mean(axis=0) == pytest.approx([-4.0, 4.0], abs=0.05)


@pytest.mark.parametrize("seconds", [0.1, 0.3])
def test_a_wheel_waits_before_it_starts(seconds: float) -> None:
    measured = lag_of_second(f"start_delay:seconds={seconds},robot=1")
    assert measured == pytest.approx(seconds, abs=3e-3)


def test_a_wheel_waits_before_it_turns_the_other_way_and_not_before_it_slows_down() -> None:
    told = [FULL] * 15 + [1.0] * 15 + [-1.0] * 15
    path = drive(lambda step: (told[step],) * 2, 1.76, "start_delay:seconds=0.2,robot=1")
    ahead = path.ahead
    slower = ahead[30] - ahead[16]
    assert slower[1] == pytest.approx(slower[0], rel=0.02)
    back = ahead[-1] - ahead[30]
    assert back[1] - back[0] == pytest.approx(0.2 * k.WHEEL_RADIUS, rel=0.06)


@pytest.mark.parametrize("rate", [8.0, 20.0])
def test_a_ramp_costs_half_the_time_that_it_takes(rate: float) -> None:
    measured = lag_of_second(f"slew_limit:rate={rate},robot=1")
    assert measured == pytest.approx(0.5 * FULL / rate, abs=0.012)  # less than motors lose without


@pytest.mark.parametrize("wheel", ["left", "right", "both"])
def test_a_wheel_commanded_within_its_dead_zone_stands_still(wheel: str) -> None:
    path = drive(
        lambda step: (1.0, 1.0), 1.0, f"motor_dead_zone:threshold=1.2,wheel={wheel},robot=1"
    )
    speeds = path.encoders[10:, 1].mean(axis=0)
    dead = {"left": (0.0, 1.0), "right": (1.0, 0.0), "both": (0.0, 0.0)}[wheel]
    assert speeds == pytest.approx(dead, abs=0.05)


def test_a_dead_zone_leaves_faster_commands_alone() -> None:
    assert speed_ratio("motor_dead_zone:threshold=5.9,robot=1") == pytest.approx(1.0, abs=1e-3)


def test_a_drooping_motor_loses_its_share_of_speed_every_second() -> None:
    rate = 0.05
    path = drive(straight, 2.0, f"speed_droop:rate={rate},robot=1")
    lost = path.ahead[-1, 0] - path.ahead[-1, 1]
    assert lost == pytest.approx(SPEED * rate * 2.0**2 / 2.0, rel=0.05)


def test_turned_markers_turn_the_measured_yaw_alone() -> None:
    path = drive(spin, 2.0, "tracker_yaw_offset:angle=0.1,robot=1")
    off = np.angle(np.exp(1j * (path.measured[:, :, 2] - path.true[:, :, 2]))).mean(axis=0)
    assert off == pytest.approx([0.0, 0.1], abs=3e-3)
    assert np.abs((path.measured - path.true)[:, :, :2].mean(axis=0)).max() < 3e-4
    assert np.abs(path.measured[:, :, 2]).max() < math.pi + 0.05


def test_markers_off_centre_circle_about_a_spinning_robot() -> None:
    path = drive(spin, 2.0, "tracker_offset:x=0.01,y=-0.004,robot=1")
    off = path.measured[:, :, :2] - path.true[:, :, :2]
    c, s = np.cos(path.true[:, :, 2]), np.sin(path.true[:, :, 2])
    ahead = (c * off[..., 0] + s * off[..., 1]).mean(axis=0)
    left = (c * off[..., 1] - s * off[..., 0]).mean(axis=0)
    assert ahead == pytest.approx([0.0, 0.01], abs=3e-4)
    assert left == pytest.approx([0.0, -0.004], abs=3e-4)


@pytest.mark.parametrize("seconds", [0.016, 0.043, 0.1])
def test_a_late_clock_reports_where_the_robot_was(seconds: float) -> None:
    def busy(step: int) -> tuple[float, float]:
        return (-4.0, 4.0) if step < 25 else (FULL, FULL)

    path = drive(busy, 2.0, f"clock_offset:seconds={seconds},robot=1")
    t = 0.04 * np.arange(51)
    for axis in range(2):
        then = np.interp(t - seconds, t, path.true[:, 1, axis])
        late = path.measured[:, 1, axis] - then
        assert abs(late.mean()) < 3e-4
        assert np.abs(late).max() < 4e-3
    then = np.interp(t - seconds, t, path.turned[:, 1])
    late = np.angle(np.exp(1j * (path.measured[:, 1, 2] - then)))
    assert abs(late[:20].mean()) < 5e-3


def test_a_late_clock_does_not_change_the_motion() -> None:
    late = drive(straight, 0.4, "clock_offset:seconds=0.05,robot=1")
    assert (late.true == drive(straight, 0.4).true).all()


def test_a_tilted_floor_lets_a_robot_without_motors_roll_downhill() -> None:
    slope = 0.1
    specs = (f"floor_tilt:slope={slope}", "weak_motor:torque=1e-6,robot=1")
    path = drive(rest, 0.8, *specs)
    rolling = 1.0 + 2.0 * k.WHEEL_INERTIA / k.WHEEL_RADIUS**2 / k.MASS
    expected = 0.5 * k.GRAVITY * math.sin(slope) / rolling * 0.8**2
    assert path.ahead[-1, 1] == pytest.approx(expected, rel=0.05)
    assert path.ahead[-1, 0] < 0.05 * expected  # motors hold


def test_a_floor_tilts_in_the_direction_asked_for() -> None:
    specs = ("floor_tilt:slope=0.1,direction=3.14159", "weak_motor:torque=1e-6,robot=1")
    assert drive(rest, 0.4, *specs).ahead[-1, 1] < -0.05


def test_encoders_count_whole_steps_of_the_wheels() -> None:
    path = drive(straight, 2.0)
    steps = path.encoders * k.CONTROL_STEP / k.WHEEL_STEP
    assert steps == pytest.approx(np.rint(steps), abs=1e-9)
    turned = path.encoders.sum(axis=0) * k.CONTROL_STEP * k.WHEEL_RADIUS
    assert turned == pytest.approx(np.tile(path.ahead[-1, :, None], 2), rel=0.01)
    assert (path.encoders[0] == 0.0).all()


def test_effects_of_several_robots_and_kinds_hold_together() -> None:
    specs = (
        "wheel_radius_scale:scale=1.1,robot=1",
        "command_latency:seconds=0.08,robot=0",
        "speed_droop:rate=0.02,robot=1",
    )
    path = drive(straight, 2.0, *specs)
    ahead = SPEED * np.array([2.0 - 0.08, 1.1 * (2.0 - 0.02 * 2.0)])
    assert path.ahead[-1] == pytest.approx(ahead, rel=0.01)


def test_wheels_turn_at_their_share_of_what_they_are_told() -> None:
    path = drive(lambda step: (4.0, 4.0), 1.0, "motor_gain:left=0.9,right=0.8,robot=1")
    assert path.encoders[10:, 1].mean(axis=0) == pytest.approx([3.6, 3.2], rel=5e-3)

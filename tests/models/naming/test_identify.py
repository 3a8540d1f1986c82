"""Faults hidden in logs that the point model itself made, and found again."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, replay
from realitygap.models.belief.catalogue import causes, where
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.belief.motion import Motion
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.motion.diagnose import diagnose
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.predict import poses, wheel_angles
from realitygap.models.naming.channels.motion.tracks import Tracks, cut_tracks
from realitygap.models.naming.diagnosis import Diagnosis, alternatives, as_json
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.health.learned import fit_inherent, make_reference, told_of
from realitygap.models.naming.health.reference import INHERENT, Reference
from tests.models.small import driven_log

MODEL = read_model_file("epuck").model_copy(update={"arena": None})
HEALTHY = Drive(acceleration=(160.0, 160.0), time_constant=0.01)
"""What sound robots of these tests do: more than the minimal model knows."""
RECORDER, STEP = "test", 0.04
"""What these logs say of how they were recorded; s."""


def table(seed: int, drives: dict[int, Drive], robots: int = 3, rows: int = 1500) -> pd.DataFrame:
    """A swarm's log: every robot healthy but for those with a drive of their own."""
    parts = []
    for robot in range(robots):
        drive = drives.get(robot, HEALTHY)
        one = driven_log(
            100 * seed + robot,
            robots=1,
            rows=rows,
            drive=drive,
            position_noise=5e-4,
            heading_noise=5e-3,
        )
        parts.append(one.assign(robot=robot))
    return pd.concat(parts, ignore_index=True)


def tracks(frame: pd.DataFrame) -> Tracks:
    return cut_tracks(make_log(frame, drive=MODEL.motion().drive), MODEL)


@cache
def reference() -> Reference:
    swarms = [tracks(table(seed, {})) for seed in range(1, 7)]
    drive = MODEL.motion().drive
    inherent = np.mean([fit_inherent(one, drive) for one in swarms[:2]], axis=0)
    healthy = INHERENT.applied(Motion(drive=drive), inherent)
    told = [told_of(one, healthy) for one in swarms]
    made = make_reference(told, inherent, model="e-puck", drive=drive, command="test")
    return made.model_copy(update={"recorder": RECORDER, "step": STEP})


def diagnosed(frame: pd.DataFrame, known: Reference | None = None) -> Diagnosis:
    frame.attrs.setdefault("recorder", RECORDER)
    log = make_log(frame, drive=MODEL.motion().drive)
    return diagnose(log, MODEL, known or reference()).diagnosis


def names(found: Diagnosis) -> list[tuple[str, tuple[int, ...]]]:
    return [(one.term.cause.name, one.robots) for one in found.named]


def test_the_inherent_motion_of_healthy_robots_is_measured() -> None:
    motion = reference().motion(MODEL.motion())
    assert motion.drive.acceleration[0] == pytest.approx(160.0, rel=0.1)
    assert motion.drive.time_constant == pytest.approx(0.01, abs=0.002)
    assert motion.drive.wheel_radius[0] == pytest.approx(0.0205, rel=2e-3)


def test_healthy_robots_are_left_alone() -> None:
    found = diagnosed(table(7, {}))
    assert found.verdict == "nothing_wrong"
    assert as_json(found)["causes"] == []


@pytest.mark.parametrize(
    ("drive", "name", "parameter", "value"),
    [
        (replace(HEALTHY, wheel_radius=(0.0203, 0.0207)), "wheel_radius_mismatch", "ratio", 1.0197),
        (replace(HEALTHY, wheel_radius=(0.0209, 0.0209)), "wheel_radius_scale", "scale", 1.0195),
        (replace(HEALTHY, axle=0.05406), "wheel_separation", "scale", 1.02),
        (replace(HEALTHY, droop_rate=1.5e-3), "speed_droop", "rate", 1.5e-3),
        (replace(HEALTHY, speed_limit=(4.0, np.inf)), "motor_saturation", "limit", 4.0),
        (replace(HEALTHY, dead_zone=(0.9, 0.9)), "motor_dead_zone", "threshold", 0.9),
        (replace(HEALTHY, turn_first=4.0), "turn_first", "limit", 4.0),
        (replace(HEALTHY, start_delay=0.06), "start_delay", "seconds", 0.06),
    ],
)
def test_a_fault_of_one_robot_is_named_with_its_value(
    drive: Drive, name: str, parameter: str, value: float
) -> None:
    found = diagnosed(table(8, {1: drive}))
    assert names(found) == [(name, (1,))]
    assert found.verdict == "named"
    told = found.named[0].values[0]
    assert told.name == parameter
    assert told.low <= value <= told.high


def test_late_commands_and_late_poses_are_one_class_until_encoders_tell() -> None:
    late = replace(HEALTHY, latency=0.06)
    frame = table(9, {2: late})
    found = diagnosed(frame)
    assert found.verdict == "ambiguous"
    assert names(found) == [("command_latency", (2,))]
    assert alternatives(found.named[0]) == ["clock_offset"]

    told = diagnosed(with_encoders(frame, {2: late}))
    assert told.verdict == "named"
    assert names(told) == [("command_latency", (2,))]
    stamped = diagnosed(with_encoders(frame, {}))
    assert names(stamped) == [("clock_offset", (2,))]


def with_encoders(frame: pd.DataFrame, drives: dict[int, Drive]) -> pd.DataFrame:
    """The log with what encoders of 1000 steps a turn would have measured."""
    cut = tracks(frame)
    motions = [Motion(drive=drives.get(robot, HEALTHY)) for robot in cut.robots]
    ticks = np.floor(wheel_angles(cut, motions) / (2 * np.pi / 1000))
    speed = np.diff(ticks, axis=0, prepend=ticks[:1]) * (2 * np.pi / 1000) / 0.04
    speed[cut.start[:-1]] = 0.0
    return frame.assign(wheel_left=speed[:, 0], wheel_right=speed[:, 1])


def test_a_rotated_marker_is_not_taken_for_wheels_of_two_sizes() -> None:
    frame = table(10, {})
    frame.loc[frame["robot"] == 0, "yaw"] += 0.03
    found = diagnosed(frame)
    assert names(found) == [("tracker_yaw_offset", (0,))]


def test_what_the_whole_swarm_has_is_said_of_all() -> None:
    wide = replace(HEALTHY, wheel_radius=(0.0207, 0.0207))
    found = diagnosed(table(11, dict.fromkeys(range(3), wide)))
    assert names(found) == [("wheel_radius_scale", (0, 1, 2))]
    assert as_json(found)["causes"][0]["robots"] == "all"


def test_a_fault_outside_the_catalogue_is_called_unexplained() -> None:
    frame = table(12, {})
    # the floor drags along one axis: speed follows the way a robot faces
    frame.loc[frame["robot"] == 1, "x"] *= 1.06
    found = diagnosed(frame)
    assert found.verdict == "unexplained"
    assert found.unexplained[0].robots == (1,)
    assert found.unexplained[0].quantity == "heading_twice"


def test_without_a_reference_it_says_what_it_cannot_claim() -> None:
    frame = table(13, {1: replace(HEALTHY, axle=0.056)})
    log = make_log(frame, drive=MODEL.motion().drive)
    found = diagnose(log, MODEL, None).diagnosis
    assert any("no healthy reference" in said for said in found.not_checked)
    assert found.reference == ""


def test_the_same_log_gives_the_same_diagnosis() -> None:
    frame = table(14, {1: replace(HEALTHY, axle=0.0545)})
    assert as_json(diagnosed(frame)) == as_json(diagnosed(frame))


def test_names_do_not_depend_on_the_order_or_ids_of_robots() -> None:
    frame = table(15, {1: replace(HEALTHY, axle=0.0545)})
    renamed = frame.assign(robot=frame["robot"].map({0: 7, 1: 3, 2: 5}))
    assert names(diagnosed(renamed)) == [("wheel_separation", (3,))]


def test_a_fit_is_the_least_squares_optimum_of_its_term() -> None:
    cut = tracks(table(16, {}, robots=1))
    healthy = reference().motion(MODEL.motion())
    term = Term(causes()["tracker_offset"], "")
    moved = term.cause.applied(healthy, np.array([0.002, -0.001]))
    noise = np.random.default_rng(0).normal(0, 1, (len(cut.rows), 3)) * [5e-4, 5e-4, 5e-3]
    seen = replace(cut, measured=poses(cut, [moved]) + noise)
    fit = Problem(seen, [healthy]).fit((term,), [np.zeros((1, 2))])
    error = np.sqrt(np.diag(fit.covariance[0]))
    assert (np.abs(fit.coordinates[0] - [0.002, -0.001]) < 4 * error).all()
    assert (error < 3e-4).all()


def test_early_poses_are_replayed_exactly() -> None:
    cut = tracks(table(17, {}, robots=1))
    early = poses(cut, [Motion(drive=HEALTHY, pose_delay=-0.04)])
    now = poses(cut, [Motion(drive=HEALTHY)])
    row = cut.rows[:-1] + 1 == cut.rows[1:]
    # what is stamped a row too early is where the robot will be a row later, once it moves
    apart = np.diff(early[:-1][row][:, 2]) - np.diff(now[1:][row][:, 2])
    assert np.abs(apart[50:]).max() < 1e-9


def manoeuvre(
    commands: np.ndarray, seed: int, *, drive: Drive, dead: float = 0.0, step: float = 0.04
) -> pd.DataFrame:
    """One robot's log of given commands; for `dead` s after a start from rest it does not move."""
    rows = len(commands)
    t = step * np.arange(rows)
    still = ~commands.any(axis=1)
    started = np.flatnonzero(~still & np.append(True, still[:-1]))
    given = commands.copy()
    for row in started:
        given[row : row + round(dead / step)] = 0.0
    driven = replay(t, given, [0, rows], np.zeros((1, 3)), drive=drive).poses
    seen = driven + np.random.default_rng(seed).normal(0, 1, (rows, 3)) * [5e-4, 5e-4, 5e-3]
    columns = dict(zip(("x", "y", "yaw"), seen.T, strict=True))
    columns |= dict(zip(("cmd_left", "cmd_right"), commands.T, strict=True))
    return pd.DataFrame({"run": f"r{seed}", "robot": 0, "t": t, **columns})


def test_a_dead_time_at_starts_is_named_and_not_after_a_cause_that_half_resembles_it() -> None:
    rng = np.random.default_rng(18)
    drives = np.repeat(rng.uniform(1.5, 6.0, (40, 2)), 50, axis=0).reshape(40, 50, 2)
    rests = np.zeros((40, 12, 2))
    commands = np.concatenate([rests, drives], axis=1).reshape(-1, 2)
    found = diagnosed(manoeuvre(commands, 18, drive=HEALTHY, dead=0.44))
    assert found.verdict == "named"
    assert names(found) == [("start_delay", (0,))]
    assert found.named[0].values[0].value == pytest.approx(0.44, abs=2e-3)


def test_a_ramp_is_told_in_its_own_unit_where_nobody_knows_what_healthy_motors_do() -> None:
    frame = table(22, {}, robots=1).assign(robot=1)
    ramped = table(23, {0: Drive(acceleration=(14.0, 14.0))}, robots=1)
    log = make_log(pd.concat([frame, ramped]), drive=MODEL.motion().drive)
    with where("differential", measured=False):
        found = diagnose(log, MODEL, None).diagnosis
    told = {(one.term.cause.name, one.robots): one.values[0] for one in found.named}
    rate = told["slew_limit", (0,)]
    assert rate.low <= 14.0 <= rate.high
    assert rate.high - rate.low < 1.0
    assert ("slew_limit", (0,)) not in names(diagnosed(ramped))


def test_a_robot_of_skid_steer_slips_and_scrubs_and_has_no_other_wheels() -> None:
    slip = causes()["side_slip"].change(MODEL.motion(), np.array([0.3]), "").drive
    drive = replace(slip, wheel_radius=(0.0205 * 0.43,) * 2, axle=0.053 * 2.4)
    log = make_log(table(24, {0: drive}, robots=1, rows=3000), drive=MODEL.motion().drive)
    with where("skid"):
        found = diagnose(log, MODEL, None).diagnosis
    told = {one.term.cause.name: one.values[0] for one in found.named}
    truth = {"slip": 0.43, "effective_axle": 2.4, "side_slip": 0.3}
    assert told.keys() == truth.keys()
    assert all(told[name].low <= value <= told[name].high for name, value in truth.items())


def test_circles_do_not_tell_the_axle_from_wheels_of_two_sizes() -> None:
    wide = replace(HEALTHY, axle=0.056)
    runs = [
        manoeuvre(np.tile([2.0, 4.0][:: 1 - 2 * (k % 2)], (700, 1)), k, drive=wide)
        for k in range(4)
    ]
    found = diagnosed(pd.concat(runs, ignore_index=True))
    assert found.verdict == "ambiguous"
    assert names(found) == [("wheel_separation", (0,))]
    assert alternatives(found.named[0]) == ["wheel_radius_mismatch"]


@pytest.mark.parametrize(("axle", "named"), [(0.0536, False), (0.0555, True)])
def test_beside_an_unknown_drift_of_all_only_a_true_fault_is_named_and_only_a_large_one(
    axle: float, named: bool
) -> None:
    frame = table(19, {1: replace(HEALTHY, axle=axle)})
    frame["x"] += 0.004 * frame["t"]  # speed and slip follow the way they face
    found = diagnosed(frame)
    assert found.verdict == "unexplained"
    assert found.unexplained[0].robots == "all"
    assert found.unexplained[0].quantity == "heading"
    assert names(found) == ([("wheel_separation", (1,))] if named else [])


@pytest.mark.parametrize(("axle", "both"), [(1.01, False), (1.1, True)])
def test_beside_slipping_wheels_only_more_than_they_feign_is_named(axle: float, both: bool) -> None:
    """On a floor, wheels that slip look like another axle by a per cent."""
    slips = replace(HEALTHY, acceleration=(30.0, 30.0), axle=0.053 * axle)
    found = diagnosed(table(21, {1: slips}))
    told = {one.term.cause.name for one in found.named}
    assert ("wheel_separation" in told) is both
    assert told & {"weak_motor", "low_friction"}
    assert not found.unexplained

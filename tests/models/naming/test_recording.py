"""How a log was recorded is nobody's fault, and hides nobody's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import ALL
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.driven import recorded as as_recorded
from realitygap.models.log.measured import make_log, read_log
from realitygap.models.log.table_files import RECORDER
from realitygap.models.naming.channels.motion.recorded import recorded
from realitygap.models.naming.channels.motion.recording import recording, unsure
from realitygap.models.naming.diagnosis import Diagnosis
from realitygap.models.naming.rules import Rules
from tests.models.naming.test_identify import HEALTHY, MODEL, STEP, names, reference, table, tracks
from tests.models.naming.test_identify import diagnosed as told_of

Change = Callable[[pd.DataFrame], pd.DataFrame]
POSE = ["x", "y", "yaw"]
ILL = {1: replace(HEALTHY, wheel_radius=(0.0203, 0.0207))}


def diagnosed(frame: pd.DataFrame) -> Diagnosis:
    """Of a log that does not say how it was recorded."""
    frame.attrs["recorder"] = ""
    return told_of(frame)


def by_robot(change: Change) -> Change:
    """A change of every robot's log by itself."""

    def changed(frame: pd.DataFrame) -> pd.DataFrame:
        parts = [change(own.reset_index(drop=True)) for _, own in frame.groupby("robot")]
        return pd.concat(parts, ignore_index=True)

    return changed


def unwrapped(frame: pd.DataFrame) -> FloatArray:
    poses = frame[POSE].to_numpy(dtype=float).copy()
    poses[:, 2] = np.unwrap(poses[:, 2])
    return np.asarray(poses)


def with_poses(frame: pd.DataFrame, poses: FloatArray) -> pd.DataFrame:
    return frame.assign(**dict(zip(POSE, np.asarray(poses, dtype=float).T, strict=True)))


def at(frame: pd.DataFrame, times: FloatArray) -> FloatArray:
    """(times, 3) poses between rows."""
    poses, t = unwrapped(frame), frame["t"].to_numpy()
    return np.column_stack([np.interp(times, t, poses[:, k]) for k in range(3)])


def averaged(frame: pd.DataFrame) -> pd.DataFrame:
    three = pd.DataFrame(unwrapped(frame)).rolling(3, center=True, min_periods=1).mean()
    return with_poses(frame, three.to_numpy())


def fast(frame: pd.DataFrame) -> pd.DataFrame:
    t = frame["t"].to_numpy()
    return with_poses(frame, at(frame, t * (1.0 + 1e-3)))


def merged(frame: pd.DataFrame) -> pd.DataFrame:
    """Commands half a row too late in the log: the poses' rows lie between theirs."""
    t = frame["t"].to_numpy() + 0.5 * STEP
    return with_poses(frame, at(frame, t)).assign(t=t)


def filtered(frame: pd.DataFrame) -> pd.DataFrame:
    """By a causal filter of 80 ms."""
    poses, share = unwrapped(frame), 1.0 - np.exp(-STEP / 0.08)
    for k in range(1, len(poses)):
        poses[k] = poses[k - 1] + share * (poses[k] - poses[k - 1])
    return with_poses(frame, poses)


def jittered(frame: pd.DataFrame) -> pd.DataFrame:
    seed = np.random.SeedSequence([45, int(frame["robot"].iloc[0])])
    off = np.random.default_rng(seed).normal(0.0, 0.005, len(frame))
    return frame.assign(t=frame["t"] + np.clip(off, -0.015, 0.015))


def held(frame: pd.DataFrame) -> pd.DataFrame:
    return with_poses(frame, frame[POSE].to_numpy()[np.arange(len(frame)) // 2 * 2])


def sparse(every: int) -> Change:
    def some(frame: pd.DataFrame) -> pd.DataFrame:
        poses = frame[POSE].to_numpy(dtype=float).copy()
        poses[np.arange(len(frame)) % every != 0] = np.nan
        return with_poses(frame, poses)

    return some


CHANGES: dict[str, Change] = {
    "every second row": lambda frame: frame.iloc[::2],
    "average of three": averaged,
    "clock rate": fast,
    "merged": merged,
    "held poses": held,
    "causal filter": filtered,
    "jittered stamps": jittered,
    "every second pose": sparse(2),
    "every fifth pose": sparse(5),
    "scale": lambda frame: frame.assign(x=1.01 * frame["x"], y=1.01 * frame["y"]),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_healthy_robots_are_not_accused_of_how_their_log_was_recorded(change: Change) -> None:
    found = diagnosed(by_robot(change)(table(41, {})))
    assert names(found) == []
    assert found.unexplained == ()


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_an_ill_robot_is_found_however_its_log_was_recorded(change: Change) -> None:
    found = diagnosed(by_robot(change)(table(42, ILL)))
    assert names(found) == [("wheel_radius_mismatch", (1,))]
    value = found.named[0].values[0]
    assert value.value == pytest.approx(207 / 203, abs=0.004)


@pytest.mark.parametrize(
    ("change", "what", "value", "within"),
    [
        ("average of three", "smear", 2.0 / 3.0 * STEP**2, 2e-4),
        ("clock rate", "clock_rate", -1e-3, 5e-5),
        ("merged", "pose_delay", -0.5 * STEP, 4e-3),
        ("scale", "pose_scale", 1.01, 2e-3),
        ("causal filter", "pose_lag", 0.08, 0.015),
    ],
)
def test_what_lies_between_robots_and_rows_is_measured(
    change: str, what: str, value: float, within: float
) -> None:
    log = replace(
        tracks(by_robot(CHANGES[change])(table(43, {}))), filtered=change == "causal filter"
    )
    healthy = reference().motion(MODEL.motion())
    (first, *_) = recorded(log, (healthy,) * len(log.robots), reference().learned).base
    own = getattr(healthy, what)
    assert getattr(first, what) == pytest.approx(
        value + (own if what == "pose_delay" else 0), abs=within
    )


def test_a_robot_that_is_late_is_no_log_that_is_late() -> None:
    healthy = reference().motion(MODEL.motion())
    late = replace(HEALTHY, latency=HEALTHY.latency + 0.1)
    log = tracks(table(44, {1: late}, robots=6, rows=600))
    (first, *_) = recorded(log, (healthy,) * len(log.robots), reference().learned).base
    assert first.pose_delay == pytest.approx(healthy.pose_delay, abs=2e-3)


def test_an_average_of_rows_has_the_variance_that_it_is_told() -> None:
    """A corner smeared by a kernel of variance s^2 lies s^2 / 2 times its bend beside."""
    t = STEP * np.arange(101)
    path = np.column_stack([0.5 * t**2, np.zeros(101), np.zeros(101)])
    for smear in (1e-4, 1e-3, 1e-2):
        motion = Motion(drive=Drive(), smear=smear)
        moved = as_recorded(t, path, np.array([0, 101]), motion) - path
        np.testing.assert_allclose(moved[45:55, 0], 0.5 * smear, rtol=1e-9)


def test_a_filter_lags_behind_by_its_time_constant() -> None:
    """A steady ramp comes out late by the filter's delay: with short steps its time constant."""
    t = 0.001 * np.arange(2001)
    path = np.column_stack([0.1 * t, np.zeros(2001), -0.5 * t])
    cut, lag = np.array([0, 2001]), 0.08
    behind = path - as_recorded(t, path, cut, Motion(drive=Drive(), pose_lag=lag))
    np.testing.assert_allclose(behind[-1], [0.1 * lag, 0.0, -0.5 * lag], rtol=0.01)
    np.testing.assert_array_equal(behind[0], 0.0)


def test_nothing_recorded_leaves_a_path_as_it_was_to_the_bit() -> None:
    path = np.random.default_rng(0).normal(size=(50, 3))
    t = STEP * np.arange(50)
    same = as_recorded(t, path, np.array([0, 50]), Motion(drive=Drive()))
    assert same.tobytes() == path.tobytes()


def late(seconds: float) -> pd.DataFrame:
    return table(44, dict.fromkeys(range(3), replace(HEALTHY, latency=seconds)))


def test_what_a_merge_may_have_done_to_all_is_no_fault_of_a_swarm() -> None:
    found = diagnosed(late(0.025))
    assert names(found) == []


def test_where_the_same_recorder_made_log_and_reference_it_is_one() -> None:
    found = told_of(late(0.025))
    assert [one.whole_swarm for one in found.named] == [True]
    assert found.named[0].term.cause.name in ("command_latency", "clock_offset")


def test_a_log_that_was_thinned_afterwards_is_not_its_recorders() -> None:
    known = reference()
    assert known.recorded_like(known.recorder, STEP)
    assert not known.recorded_like(known.recorder, 2.0 * STEP)
    assert not known.recorded_like("", STEP)
    assert not known.model_copy(update={"recorder": ""}).recorded_like("", STEP)
    assert not known.model_copy(update={"step": 0.0}).recorded_like(known.recorder, STEP)


def test_a_file_says_what_recorded_it(tmp_path) -> None:  # type: ignore[no-untyped-def]
    content = pa.Table.from_pandas(table(45, {}, rows=50), preserve_index=False)
    pq.write_table(content.replace_schema_metadata({RECORDER: b"lab"}), tmp_path / "log.parquet")
    pq.write_table(content, tmp_path / "other.parquet")
    drive = MODEL.motion().drive
    assert read_log(tmp_path / "log.parquet", drive=drive).recorder == "lab"
    assert read_log(tmp_path / "other.parquet", drive=drive).recorder == ""


def test_poses_that_are_held_are_used_once_and_it_is_said() -> None:
    frame = by_robot(held)(table(46, {}))
    log = make_log(frame, drive=MODEL.motion().drive)
    assert any("repeat a pose" in note for note in log.notes)
    assert log.tracked.mean() == pytest.approx(0.5, abs=0.01)


def test_robots_at_rest_may_repeat_their_pose() -> None:
    frame = table(47, {})
    still = frame["t"] > 40.0
    frame.loc[still, ["cmd_left", "cmd_right"]] = 0.0
    frame.loc[still, POSE] = [0.1, 0.2, 0.3]
    log = make_log(frame, drive=MODEL.motion().drive)
    assert not any("repeat a pose" in note for note in log.notes)


def test_only_what_shows_where_commands_change_is_unsure_beside_the_recording() -> None:
    listed = ["wheel_radius_scale.scale", "motor_lag.time_constant", "low_friction@0.5"]
    found = unsure(0.1, [*listed, "clock_offset.seconds", "speed/heading sin"], Rules())
    assert found["motor_lag.time_constant"] == 0.05
    assert "low_friction@0.5" in found
    assert not {"wheel_radius_scale.scale", "clock_offset.seconds", "speed/heading sin"} & set(
        found
    )
    assert {p.name for p in recording(0.1, Rules(), filtered=True).parameters} == {
        name.partition("@")[2] for name in found if name.startswith("recording@")
    }
    assert recording(0.1, Rules()).variants == (ALL,)

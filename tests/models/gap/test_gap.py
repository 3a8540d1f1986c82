import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from realitygap.embedded_sim import Drive, InputError, PointModel
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.gap.motion_gap import condition_bins
from realitygap.models.gap.whole import LEVEL, measure_gap
from realitygap.models.log.measured import make_log
from tests.models.small import arena_log, driven_log, tables

EPUCK = read_model_file("epuck")
OPEN = EPUCK.model_copy(update={"arena": None})
MODEL = PointModel(tables=tables())
MOTION = PointModel()


def gap_of(frame, *, sensors=True, seed=0):
    log = make_log(frame, drive=Drive())
    return measure_gap(log, EPUCK if sensors else OPEN, MODEL if sensors else MOTION, seed=seed)


def flagged_conditions(gap, *, channel, horizon="1 s"):
    return {
        m.condition
        for kind, h, m in gap.maps()
        if h == horizon and m.channel == channel and m.p <= LEVEL
    }


def test_the_noise_is_found_although_the_model_is_wrong():
    drive = Drive(wheel_radius=(0.0205, 0.0213), axle=0.056, time_constant=0.08)
    for position, heading in ((5e-4, 5e-3), (2e-3, 2e-2)):
        frame = driven_log(
            1, rows=3000, drive=drive, position_noise=position, heading_noise=heading
        )
        noise = gap_of(frame, sensors=False).noise
        assert noise.position == pytest.approx(position, rel=0.1)
        assert noise.heading == pytest.approx(heading, rel=0.1)


def test_noise_alone_fills_the_error_of_a_log_the_model_made_itself():
    gap = gap_of(arena_log(2, rows=3000))
    for kind, horizon, channel, share in gap.shares():
        if horizon != "20 s":
            assert share.noise > 0.85, (kind, horizon, channel, share)
    middle = gap.horizons.groupby("horizon").median(numeric_only=True)
    assert np.allclose(middle["position_median"], middle["position_noise"], rtol=0.25)


def battery(seeds):
    """Share of logs made by the point model itself, plus noise, in which anything is flagged."""
    return np.mean([gap_of(arena_log(seed), seed=seed).flagged for seed in seeds])


def test_few_logs_the_model_made_itself_are_flagged():
    assert battery(range(9000, 9012)) <= 0.25


@pytest.mark.slow
def test_at_most_five_per_cent_of_two_hundred_logs_the_model_made_itself_are_flagged():
    assert battery(range(200)) <= 0.05


@pytest.mark.parametrize(
    ("drive", "channel", "condition"),
    [
        (Drive(wheel_radius=(0.0203, 0.0207)), "heading", "speed"),
        (Drive(axle=0.0545), "heading", "turn"),
        (Drive(wheel_radius=(0.0209, 0.0209)), "along", "speed"),
        (Drive(latency=0.04), "heading", "turn_change"),
        (Drive(time_constant=0.04), "along", "speed_change"),
    ],
)
def test_a_wrong_drive_is_flagged_and_shown_where_it_matters(drive, channel, condition):
    frame = driven_log(3, robots=3, rows=3000, drive=drive, position_noise=5e-4, heading_noise=5e-3)
    gap = gap_of(frame, sensors=False)
    assert gap.flagged
    assert condition in flagged_conditions(gap, channel=channel)


def test_only_the_robot_with_another_wheel_is_unlike_the_others():
    healthy = arena_log(4, robots=6, rows=3000)
    wrong = arena_log(5, robots=1, rows=3000, drive=Drive(wheel_radius=(0.0203, 0.0207)))
    frame = healthy[healthy["robot"] != 3]
    gap = gap_of(pd.concat([frame, wrong.assign(robot=3)], ignore_index=True))
    assert [odd.robot for odd in gap.robots if odd.p <= LEVEL] == ["robot 3"]


def test_robots_that_share_one_fault_are_not_unlike_one_another():
    faulty = [
        gap_of(arena_log(seed, robots=5, drive=Drive(axle=0.056)), seed=seed) for seed in range(4)
    ]
    assert sum(any(odd.p <= LEVEL for odd in gap.robots) for gap in faulty) <= 1


@pytest.mark.parametrize(
    ("column", "change", "kind"),
    [("ps7", lambda v: 0.0 * v, "ps"), ("ls0", lambda v: 4095 - 0.9 * (4095 - v), "ls")],
)
def test_a_sensor_that_reads_wrong_is_flagged_alone(column, change, kind):
    frame = arena_log(6, rows=4000, robots=4)
    frame[column] = change(frame[column])
    gap = gap_of(frame)
    wrong = {m.channel for k, _, m in gap.maps() if k == kind and m.p <= LEVEL}
    assert wrong == {column}


def test_gross_failures_of_the_tracker_change_little():
    frame = arena_log(7, rows=3000)
    rng = np.random.default_rng(np.random.SeedSequence(1))
    wild = rng.choice(len(frame), len(frame) * 3 // 100, replace=False)
    clean = gap_of(frame)
    frame.loc[wild, ["x", "y"]] += rng.normal(0, 0.2, (len(wild), 2))
    dirty = gap_of(frame)
    assert not dirty.flagged
    assert dirty.noise.position == pytest.approx(clean.noise.position, rel=0.1)
    for a, b in zip(clean.shares(), dirty.shares(), strict=True):
        assert b[3].rms == pytest.approx(a[3].rms, rel=0.4), a[:3]


def test_the_result_depends_on_the_log_and_the_seed_alone():
    first, second = (gap_of(arena_log(8)) for _ in range(2))
    assert first.horizons.equals(second.horizons)
    assert [m.p for *_, m in first.maps()] == [m.p for *_, m in second.maps()]


def test_conditions_of_judged_windows_do_not_share_their_measurements():
    log = make_log(arena_log(9), drive=Drive())
    gap = measure_gap(log, EPUCK, MODEL)
    for motion in gap.motion:
        assert (motion.pairs.first[1:] > motion.pairs.last[:-1] + 1)[
            np.diff(log.segment[motion.pairs.first]) == 0
        ].all()
        assert len(condition_bins(log, motion.table)["all"].group) == len(motion.error)


DAMAGES = st.lists(
    st.tuples(
        st.sampled_from(
            ["nan", "inf", "zero", "scale", "swap", "drop", "repeat", "shuffle", "shift", "text"]
        ),
        st.sampled_from(["t", "x", "y", "yaw", "cmd_left", "cmd_right", "robot", "ps0", "ls3"]),
        st.integers(0, 299),
        st.integers(1, 300),
        st.sampled_from([-1.0, 0.0, 1e-9, 1e-3, 57.3, 1e3, 1e9, 1e300]),
    ),
    min_size=1,
    max_size=4,
)


def damaged(frame, damages):
    """The log after a list of damages."""
    frame = frame.copy()
    for kind, column, first, length, factor in damages:
        if not len(frame):
            break
        rows = frame.index[first : first + length]
        if kind in ("nan", "inf", "zero"):
            frame[column] = frame[column].astype(float)
            frame.loc[rows, column] = {"nan": np.nan, "inf": np.inf, "zero": 0.0}[kind]
        elif kind == "scale":
            with np.errstate(over="ignore"):
                frame[column] = frame[column].astype(float) * factor
        elif kind == "shift":
            frame[column] = frame[column].astype(float)
            frame.loc[rows, column] += factor
        elif kind == "swap":
            frame = frame.rename(columns={column: "y", "y": column})
            frame = frame.loc[:, ~frame.columns.duplicated()]
        elif kind == "drop":
            frame = frame.drop(columns=column) if length > 150 else frame.drop(index=rows)
        elif kind == "repeat":
            frame = frame.iloc[np.r_[0 : len(frame), 0 : min(length, len(frame))]]
            frame = frame.reset_index(drop=True)
        elif kind == "shuffle":
            frame = frame.sample(frac=1, random_state=length).reset_index(drop=True)
        else:
            frame[column] = frame[column].astype(object)
            frame.loc[rows, column] = "n/a"
        if kind == "text" or column not in frame:
            break
    return frame


def judge(frame):
    """A gap, or a refusal in one line."""
    refusal = ""
    try:
        gap_of(frame)
    except InputError as error:
        refusal = str(error)
    assert "\n" not in refusal
    assert len(refusal) < 500


HEALTHY = arena_log(10, robots=2, rows=150)
QUIET = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)


@settings(QUIET, max_examples=60)
@given(DAMAGES)
def test_a_damaged_log_ends_in_a_gap_or_in_one_line(damages):
    judge(damaged(HEALTHY, damages))


@pytest.mark.slow
@settings(QUIET, max_examples=1000)
@given(DAMAGES)
def test_a_thousand_damaged_logs_end_in_a_gap_or_in_one_line(damages):
    judge(damaged(HEALTHY, damages))


def test_late_and_slow_motors_are_larger_than_noise_even_where_no_mean_says_so():
    drive = Drive(latency=0.1, time_constant=0.08)
    gap = gap_of(driven_log(3, rows=1500, drive=drive), sensors=False)
    assert gap.flagged
    assert {"along", "heading"} <= {channel for _, channel, _ in gap.larger()}


def test_noise_alone_is_not_larger_than_noise():
    for seed in range(8):
        assert not gap_of(arena_log(4000 + seed), sensors=False).larger()

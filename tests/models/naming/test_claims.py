"""What a diagnosis claims holds: its gain, what it exports, what it could not have seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from realitygap.embedded_sim import Drive
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.extended import as_written, extended_text, read_back
from realitygap.models.belief.motion import Motion
from realitygap.models.gap.conditions import conditions
from realitygap.models.log.blocks import Better, better, interval
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import MeasuredLog, make_log
from realitygap.models.naming.channels.motion import claims
from realitygap.models.naming.channels.motion.claims import bounded, claimed
from realitygap.models.naming.channels.motion.diagnose import diagnose
from realitygap.models.naming.channels.motion.fit import Problem
from realitygap.models.naming.channels.motion.fitted import Fitted, ToldValue, refitted
from realitygap.models.naming.channels.motion.tracks import cut_tracks
from realitygap.models.naming.claims.ahead import Ahead
from realitygap.models.naming.claims.harm import Predictions, harmless
from realitygap.models.naming.claims.prediction import prediction_errors
from realitygap.models.naming.claims.written import written
from realitygap.models.naming.diagnosis import Diagnosis, as_json, extension
from realitygap.models.naming.engine.gates import rare
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.value import Value
from tests.models.naming.test_diagnosis import named
from tests.models.naming.test_identify import HEALTHY, MODEL, diagnosed, names, reference, table
from tests.models.small import driven_log

MISMATCH = replace(HEALTHY, wheel_radius=(0.0203, 0.0207))


@cache
def healthy() -> Diagnosis:
    return diagnosed(table(7, {}))


def log_of(frame: pd.DataFrame) -> MeasuredLog:
    return make_log(frame, drive=MODEL.motion().drive)


def test_where_nothing_is_exported_nothing_is_gained_to_the_last_bit() -> None:
    found = healthy()
    assert found.verdict == "nothing_wrong"
    assert set(found.gain) == {
        f"{channel}_{ahead}s" for channel in ("position", "heading") for ahead in (1, 5, 20)
    }
    assert all(gain.before == gain.after for gain in found.gain.values())
    # the reference says of itself what the minimal model leaves of healthy robots, and it is that
    for gain in found.gain.values():
        assert gain.healthy == pytest.approx(gain.before, rel=0.1)


def test_the_gain_is_that_of_the_file_on_the_part_that_its_values_were_not_fitted_to() -> None:
    frame = table(8, {1: MISMATCH})
    found = diagnosed(frame)
    log, minimal = log_of(frame), MODEL
    [cause] = found.named
    halves = [frame[(frame["t"] < 30.0) == early] for early in (True, False)]
    total, number = 0.0, 0
    for fitted, judged in (halves, halves[::-1]):
        # the values of a half, by a diagnosis of that half alone
        [alone] = [one for one in diagnosed(fitted).named if one.key == cause.key]
        text = extended_text(
            minimal, extension(replace(found, named=(alone,)), log_hash="", command="")
        )
        models = {"before": minimal, "after": read_back(text)}
        errors = prediction_errors(log_of(judged), models, None)
        some = errors[(errors["robot"] == 1) & (errors["horizon"] == "5 s")]
        some = some[(some["channel"] == "position") & (some["model"] == "after")]
        total, number = total + some["total"].sum(), number + some["number"].sum()
    assert found.gain["position_5s"].after == pytest.approx(total / number, rel=0.02)
    assert found.gain["position_5s"].after < 0.7 * found.gain["position_5s"].before
    assert len(log.segments) == 3


def test_each_part_of_a_log_gives_the_values_that_hold_in_it() -> None:
    first = driven_log(3, robots=1, rows=1500, drive=Drive(wheel_radius=(0.0200, 0.0210)))
    then = driven_log(4, robots=1, rows=1500, drive=Drive(wheel_radius=(0.0207, 0.0203)))
    noise = np.random.default_rng(0).normal(0.0, 1.0, (3000, 3)) * [5e-4, 5e-4, 5e-3]
    both = pd.concat([first.assign(run="a"), then.assign(run="b")], ignore_index=True)
    both[["x", "y", "yaw"]] += noise
    cut = cut_tracks(log_of(both), MODEL)
    term = Term(causes()["wheel_radius_mismatch"], "")
    problem = Problem(cut, [Motion(drive=Drive())])
    fit = problem.fit((term,), [np.zeros((1, 1))])
    none = np.zeros(1)
    told = ToldValue(searched=term, term=term, mean=none)
    fitted = Fitted(problem=problem, fit=fit, told=(told,), believed=(term,))
    ratios = [refitted([fitted], part)[term, (0,)][0].value for part in (0, 1)]
    assert ratios == pytest.approx([0.0210 / 0.0200, 0.0203 / 0.0207], abs=0.004)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.sampled_from("abc"), st.integers(0, 2)), min_size=1, unique=True))
def test_every_robot_is_in_both_parts_and_runs_are_whole_where_they_can_be(
    present: Sequence[tuple[str, int]],
) -> None:
    frame = pd.concat(
        driven_log(k, robots=1, rows=40).assign(run=run, robot=robot)
        for k, (run, robot) in enumerate(present)
    )
    log = log_of(frame)
    part, robot = parts(log), log.frame["robot"].to_numpy()
    run = log.frame["run"].to_numpy()
    for one in np.unique(robot):
        mine = robot == one
        assert set(part[mine]) == {0, 1}
        if len(np.unique(run[mine])) == 1:
            assert (np.diff(part[mine]) >= 0).all()
    for one in np.unique(run):
        apart = [
            r for r in np.unique(robot) if len(np.unique(part[(robot == r) & (run == one)])) > 1
        ]
        halved = [r for r in apart if len(np.unique(part[robot == r])) == 2]
        assert apart == halved


class Programmed:
    """Predictions that say what a test wants: how much each cause and all together help, by key."""

    useless = "useless"

    def __init__(self, of_cause: dict[int, dict[str, Better]], together: dict[str, Better]) -> None:
        self.of_cause, self.together = of_cause, together
        self.named = [named() for _ in of_cause]
        self.by_part = ({one.key: () for one in self.named},) * 2

    @staticmethod
    def harms(keys: Sequence[str]) -> str:
        return f"harms {' '.join(keys)}"

    def compare(
        self, robots: Sequence[int], before: frozenset[int], after: frozenset[int]
    ) -> dict[str, Better]:
        [*out] = after - before
        return (
            self.of_cause[out[0]]
            if before
            else self.together
            if len(out) > 1
            else self.of_cause[out[0]]
        )


HELPS = {"position_1s": Better(0.3, 1e-6), "position_20s": Better(0.2, 0.01)}
HARMS_LATER = {"position_1s": Better(0.3, 1e-6), "position_20s": Better(-0.5, 0.999)}


def test_a_cause_that_helps_now_and_harms_later_is_not_exported() -> None:
    assert harmless(Programmed({0: HELPS, 1: HARMS_LATER}, HELPS)) == {1: "harms position_20s"}


def test_a_cause_that_helps_nowhere_is_not_exported() -> None:
    chance = {"position_1s": Better(0.01, 0.3), "position_20s": Better(-0.01, 0.7)}
    assert harmless(Programmed({0: HELPS, 1: chance}, HELPS)) == {1: "useless"}


def test_causes_that_help_one_by_one_and_harm_together_are_not_exported_together() -> None:
    found = harmless(Programmed({0: HELPS, 1: {"position_1s": Better(0.1, 0.04)}}, HARMS_LATER))
    assert found == {1: "harms position_20s"}


def test_a_growth_of_errors_that_is_sure_but_tiny_is_no_harm() -> None:
    tiny = {**HELPS, "heading_5s": Better(-0.01, 0.9999)}
    assert harmless(Programmed({0: tiny}, tiny)) == {}


def test_better_is_a_paired_t_test_over_blocks() -> None:
    rng = np.random.default_rng(5)
    before, after = rng.normal(1.0, 0.2, (2, 40)).repeat(10, axis=1)
    block = np.arange(40).repeat(10)
    found = better(before, after, block)
    expected = stats.ttest_1samp(before[::10] - after[::10], 0.0, alternative="greater")
    assert found is not None
    assert found.level == pytest.approx(expected.pvalue)
    assert found.share == pytest.approx((before - after).mean() / before.mean())
    assert better(before, after, np.zeros(400)) is None


@pytest.mark.parametrize("value", [1.0, 1.0 - 1e-9, 1.3])
def test_a_value_at_its_bound_is_no_name_but_unexplained_with_the_bound(value: float) -> None:
    term = Term(causes()["motor_lag"], "")
    at_end = replace(named(), term=term, values=(Value("time_constant", value, 0.9, 1.1, "s"),))
    other = named()
    inside, ended = bounded([at_end, other])
    assert inside == (other,)
    assert [one.where for one in ended] == ["motor_lag at its bound of 1 s"]
    assert ended[0].robots == (3,)


def test_a_value_inside_its_bounds_is_a_name() -> None:
    term = Term(causes()["motor_lag"], "")
    inside = replace(named(), term=term, values=(Value("time_constant", 0.9, 0.8, 1.0, "s"),))
    assert bounded([inside]) == ((inside,), ())


def test_what_is_predicted_with_is_what_the_file_holds() -> None:
    cause = written(named(), named().values)
    file = as_written(MODEL, [cause])
    assert file.extension is not None
    assert file.extension.causes == (cause,)
    assert file.motion(3).drive.speed_limit[0] == 4.5
    assert file.motion(2) == MODEL.motion(2)


def test_what_is_not_exported_is_said_and_not_in_the_file() -> None:
    kept = replace(named(), exported=False, why="seen, but worse: not exported")
    found = Diagnosis(named=(kept,))
    assert found.verdict == "unexplained"
    assert extension(found, log_hash="", command="").causes == ()
    [cause] = as_json(found)["causes"]
    assert (cause["exported"], cause["why"]) == (False, "seen, but worse: not exported")


def test_two_seconds_of_an_ill_robot_cannot_tell() -> None:
    found = diagnosed(table(24, {1: MISMATCH}, rows=50))
    assert found.verdict == "cannot_tell"
    assert set(found.untold) == {0, 1, 2}
    size = {one.cause: one.size for one in found.detectable}
    assert all(size[name] > 0.1 for name in found.untold[1]), "a tenth is twice what must show"


def test_a_robot_that_no_fit_comes_near_is_never_called_sound() -> None:
    frame = table(23, {}, rows=375)
    ill = frame["robot"] == 1
    swapped = frame.loc[ill, ["cmd_right", "cmd_left"]].to_numpy()
    frame.loc[ill, ["cmd_left", "cmd_right"]] = swapped
    found = diagnosed(frame)
    assert found.verdict == "unexplained"
    assert (1,) in [one.robots for one in found.unexplained]


def test_an_error_far_above_the_noise_with_nothing_named_is_unexplained() -> None:
    frame = table(25, {1: replace(HEALTHY, time_constant=0.2)}, rows=400)
    log = log_of(frame)
    examined = diagnose(log, MODEL, reference())
    nothing = replace(examined.diagnosis, named=(), unexplained=())
    found = claimed(replace(examined, diagnosis=nothing), log).diagnosis
    assert found.verdict == "unexplained"
    [left] = found.unexplained
    assert (left.robots, left.quantity) == ((1,), "error")
    assert left.distance > reference().gates.error


def test_a_log_without_turns_cannot_acquit_an_axle() -> None:
    frame = table(26, {})
    for name in ("left", "right"):
        frame[f"cmd_{name}"] = np.repeat(np.random.default_rng(1).uniform(1, 5, 180), 25)
    rng = np.random.default_rng(2)
    parts_of = []
    for robot, one in frame.groupby("robot"):
        speed = 0.0205 * one["cmd_left"].to_numpy()
        x = np.concatenate([[0.0], np.cumsum(speed[:-1] * 0.04)])
        noise = rng.normal(0.0, 1.0, (len(one), 3)) * [5e-4, 5e-4, 5e-3]
        parts_of.append(
            one.assign(x=x + noise[:, 0], y=robot + noise[:, 1], yaw=noise[:, 2], robot=robot)
        )
    found = diagnosed(pd.concat(parts_of))
    size = {one.cause: one.size for one in found.detectable}
    assert size["wheel_separation"] is None
    assert all("wheel_separation" in found.untold[robot] for robot in range(3))
    assert size["wheel_radius_mismatch"] is not None


def test_a_fault_of_the_size_that_a_log_would_have_shown_is_shown() -> None:
    """Said of the healthy log, and tried in logs of the same commands and noise."""
    size = {one.cause: one for one in healthy().detectable}
    scale = size["wheel_radius_scale"].size
    axle = size["wheel_separation"].size
    ratio = size["wheel_radius_mismatch"].size
    assert None not in (scale, axle, ratio)
    radius = 0.0205
    drives = {
        0: replace(HEALTHY, wheel_radius=(radius * (1 + scale),) * 2),
        1: replace(HEALTHY, axle=0.053 * (1 + axle)),
        2: replace(HEALTHY, wheel_radius=(radius * (1 - ratio / 2), radius * (1 + ratio / 2))),
    }
    found = diagnosed(table(7, drives))
    assert {robot for _, robots in names(found) for robot in robots} == {0, 1, 2}


def test_what_is_named_is_said_to_have_been_seen() -> None:
    """As in a log of the same robots without it."""
    ill = {one.cause: one.size for one in diagnosed(table(7, {1: MISMATCH})).detectable}
    [sound] = [one.size for one in healthy().detectable if one.cause == "wheel_radius_mismatch"]
    assert ill["wheel_radius_mismatch"] == pytest.approx(sound, rel=0.1)


def test_more_of_a_log_shows_smaller_faults() -> None:
    half = diagnosed(table(7, {}, rows=750))
    short, long = ({one.cause: one.size for one in d.detectable} for d in (half, healthy()))
    for name in ("wheel_radius_scale", "wheel_separation", "wheel_radius_mismatch"):
        assert 0.0 < long[name] < short[name]


def test_every_second_of_a_robot_is_used_or_it_is_said_why_not() -> None:
    frame = table(27, {}, rows=500)
    frame.loc[(frame["robot"] == 0) & frame["t"].between(4.0, 6.0), ["x", "y", "yaw"]] = np.nan
    frame = frame[~((frame["robot"] == 1) & frame["t"].between(8.0, 12.0))]
    content = as_json(diagnosed(frame))["log"]["robots"]
    for one in content:
        shares = [v for k, v in one.items() if k not in ("robot", "seconds")]
        assert sum(shares) == pytest.approx(1.0)
        assert one["seconds"] == pytest.approx(19.96)
    assert content[0]["no_pose"] == pytest.approx(2.04 / 19.96, abs=0.005)
    assert content[1]["gaps"] == pytest.approx(4.08 / 19.96, abs=0.005)
    assert content[2]["used"] == 1.0


def test_without_a_reference_nobody_says_what_healthy_robots_leave() -> None:
    found = diagnose(log_of(table(13, {1: replace(HEALTHY, axle=0.056)})), MODEL, None).diagnosis
    assert all(gain.healthy is None for gain in found.gain.values())


def test_a_part_is_judged_by_the_values_of_the_other() -> None:
    one, log = named(), log_of(driven_log(1, robots=1, rows=600))
    of_part = [Value("limit", limit, limit, limit, "rad/s") for limit in (4.0, 5.0)]
    by_part = tuple({one.key: (value,)} for value in of_part)
    predictions = Predictions(Ahead(log, conditions(log, MODEL)), MODEL, [one], by_part)
    files = [predictions.file(frozenset({0}), part) for part in (0, 1)]
    assert [file.motion(3).drive.speed_limit[0] for file in files] == [5.0, 4.0]


def test_what_is_refused_is_not_exported_and_gains_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frame = table(8, {1: MISMATCH}, rows=500)
    log = log_of(frame)
    examined = diagnose(log, MODEL, reference())
    assert [one.exported for one in examined.diagnosis.named] == [True]
    monkeypatch.setattr(claims, "harmless", lambda predictions, rules: {0: "harms: not exported"})
    found = claimed(examined, log).diagnosis
    assert [(one.exported, one.why) for one in found.named] == [(False, "harms: not exported")]
    assert all(gain.before == gain.after for gain in found.gain.values())


def test_an_interval_of_a_mean_is_that_of_its_blocks() -> None:
    rng = np.random.default_rng(6)
    each = rng.normal(1.0, 0.2, 100)
    ends = interval(each.repeat(10), np.arange(100).repeat(10), rng)
    half = 1.96 * each.std() / 10.0
    assert np.array(ends) == pytest.approx(each.mean() + np.array([-half, half]), abs=0.25 * half)


@pytest.mark.parametrize("blocks", [2, 5, 50])
def test_few_blocks_pass_a_gate_by_chance_as_rarely_as_many(blocks: int) -> None:
    assert stats.t.sf(rare(4.3, blocks), blocks - 1) == pytest.approx(stats.norm.sf(4.3))


def test_a_robot_seen_in_one_short_stretch_alone_is_not_named() -> None:
    wide = Drive(wheel_radius=(0.0190, 0.0220))
    short = driven_log(3, robots=1, rows=60, drive=wide, position_noise=5e-4, heading_noise=5e-3)
    found = diagnose(make_log(short, drive=Drive()), MODEL, None).diagnosis
    assert found.named == ()
    assert found.verdict == "cannot_tell"


def test_a_value_that_the_halves_do_not_give_is_not_exported() -> None:
    log = log_of(table(7, {1: MISMATCH}))
    found = diagnose(log, MODEL, reference())
    (one,) = (n for n in found.diagnosis.named if n.term.cause.name == "wheel_radius_mismatch")
    wrong = replace(one, values=(one.values[0]._replace(value=0.8),))
    told = replace(found.diagnosis, named=(wrong,), unexplained=())
    (said,) = claimed(replace(found, diagnosis=told), log).diagnosis.named
    assert one.exported
    assert not said.exported
    assert "predicts worse" in said.why

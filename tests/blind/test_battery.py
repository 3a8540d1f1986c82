"""The battery draws, scores and resumes as it says; a stub stands in for the diagnosis."""

from __future__ import annotations

import json
import re
import shutil
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.log.table_files import RECORDER
from realitygap.reality.effects import parse_effects
from realitygap.studies.blind.battery import run_battery
from realitygap.studies.blind.limits import detection_limit, share
from realitygap.studies.blind.record import diagnose, record
from realitygap.studies.blind.scoring import Score, named, of_robots, outcome, score
from realitygap.studies.blind.trials import Hidden, Trial, blind_config, plan
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.run.experiment import RunConfig
from tests.browser import CHROMIUM, check_fits

STUB = partial(diagnose, command=(sys.executable, str(Path(__file__).with_name("stub.py"))))
SMALL = {"effects": ("ls_dead_sensor", "command_latency"), "robots": 3, "seconds": (2.0,)}


def trial(*hidden: Hidden, robots: int = 10) -> Trial:
    kind = "healthy" if not hidden else "single" if len(hidden) == 1 else "pair"
    return Trial(0, kind, 120.0, RunConfig(robots=robots), hidden)


def scaled(*robots: int) -> Hidden:
    return Hidden("wheel_radius_scale", {"scale": 1.02}, robots, 0.02, 2.0)


def answer(
    verdict: str, *causes: tuple[str, Any, tuple[float, float]], rivals: tuple[str, ...] = ()
) -> dict[str, Any]:
    return {
        "verdict": verdict,
        "causes": [
            {
                "name": name,
                "robots": robots,
                "parameters": {"scale": {"value": low, "low": low, "high": high, "unit": "1"}},
                "evidence": {},
                "alternatives": list(rivals),
            }
            for name, robots, (low, high) in causes
        ],
    }


IN, OUT = (1.01, 1.03), (1.03, 1.04)


def test_the_menu_holds_only_valid_values() -> None:
    random = np.random.default_rng(1)
    for name, entry in MENU.items():
        for multiple in (0.25, 1.0, 4.0):
            size = min(entry.bar * multiple, entry.largest)
            hidden = Hidden(name, dict(entry.values(size, random)), (), size, multiple)
            assert parse_effects((hidden.spec,), 10)[0].effect.name == name


def test_more_trials_extend_a_battery_and_another_seed_is_another_battery() -> None:
    effects = ("motor_lag", "wheel_separation", "lamp_moved")
    short, long = (plan(blind_config(trials=n, seed=4, effects=effects)) for n in (20, 50))
    assert long[:20] == short
    assert plan(blind_config(trials=20, seed=5, effects=effects)) != short


def test_sizes_surround_the_bar_and_pairs_exceed_it() -> None:
    trials = plan(blind_config(trials=300, seed=4, effects=("motor_lag", "wheel_separation")))
    single = [t.hidden[0].multiple for t in trials if t.kind == "single"]
    assert min(single) < 0.27
    assert max(single) > 3.7
    assert 0.8 < np.median(single) < 1.25
    assert min(h.multiple for t in trials if t.kind == "pair" for h in t.hidden) >= 1.5
    assert {len(t.hidden) for t in trials if t.kind == "healthy"} == {0}


def test_what_needs_a_lamp_is_hidden_where_one_is_lit() -> None:
    trials = plan(blind_config(trials=60, effects=("lamp_height",)))
    lit = {t.run.case for t in trials if t.kind == "single"}
    assert lit == {"light-at-nest", "light-opposite-nest"}


def test_at_the_bars_every_trial_hides_one_effect_exactly_at_its_bar_in_one_robot() -> None:
    trials = plan(blind_config(trials=30, effects=("command_latency",), at_bars=True))
    assert {t.hidden[0].values["seconds"] for t in trials} == {0.040}
    assert {len(t.hidden[0].robots) for t in trials} == {1}
    assert {t.seconds for t in trials} == {120.0}


def test_a_batterys_robots_are_built_with_the_spread_asked_for_and_nothing_else_is_drawn() -> None:
    plain, built = (
        plan(blind_config(trials=8, seed=4, effects=("motor_lag",), build_spread=spread))
        for spread in (0.0, 0.005)
    )
    assert {trial.run.build_spread for trial in built} == {0.005}
    for before, after in zip(plain, built, strict=True):
        assert after.hidden == before.hidden
        assert after.run.model_copy(update={"build_spread": 0.0}) == before.run
    with pytest.raises(InputError, match=r"--build-spread: got 0\.5"):
        blind_config(build_spread=0.5)


def test_kinds_of_trials_can_be_asked_for() -> None:
    effects = ("motor_lag", "wheel_separation", "command_latency")
    swarms = plan(blind_config(trials=4, effects=effects, at_bars=True, kinds=("swarm",)))
    hidden = [one for trial in swarms for one in trial.hidden]
    assert [one.name for one in hidden] == ["wheel_separation", "command_latency"] * 2
    assert {(one.robots, one.multiple) for one in hidden} == {((), 1.0)}
    assert hidden[1].values["seconds"] == 0.008
    turns = plan(blind_config(trials=4, effects=effects, kinds=("pair", "unlisted")))
    assert [trial.kind for trial in turns] == ["pair", "unlisted", "pair", "unlisted"]


def test_kinds_that_cannot_be_are_refused() -> None:
    with pytest.raises(InputError, match=r"--kind: got .pear., expected .*pair"):
        blind_config(effects=("motor_lag",), kinds=("pear",))
    with pytest.raises(InputError, match="--kind: got swarm, expected an effect among"):
        blind_config(effects=("motor_lag",), kinds=("swarm",))
    with pytest.raises(InputError, match="--kind: got pair, expected two effects"):
        blind_config(effects=("motor_lag",), kinds=("pair",))
    with pytest.raises(InputError, match="--kind: got healthy, expected nothing with"):
        blind_config(effects=("motor_lag",), kinds=("healthy",), leave_one_out=True)


@pytest.mark.parametrize("seconds", [-5.0, 0.5, float("nan"), float("inf")])
def test_lengths_that_no_log_has_are_refused(seconds: float) -> None:
    with pytest.raises(InputError, match="--seconds: got"):
        blind_config(effects=("motor_lag",), seconds=(seconds,))


def test_a_crowd_fits_into_the_run() -> None:
    with pytest.raises(InputError, match="--crowd: got 11, expected at most the 10 robots"):
        blind_config(effects=("motor_lag",), crowd=11)


def test_an_unknown_effect_is_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match=re.escape("did you mean motor_lag?")):
        blind_config(effects=("motor_lagg",))


@pytest.mark.parametrize(
    ("hidden", "said", "expected", "word"),
    [
        (scaled(3), answer("named", ("wheel_radius_scale", [3], IN)),
         Score("named", (True,), (False,), (), 9, 0, (True,)), "wheel_radius_scale"),
        (scaled(3), answer("named", ("wheel_radius_scale", [3], OUT)),
         Score("named", (True,), (False,), (), 9, 0, (False,)), "wheel_radius_scale"),
        (scaled(3), answer("nothing_wrong"),
         Score("nothing_wrong", (False,), (False,), (), 9, 0, ()), "nothing_wrong"),
        (scaled(3), answer("named", ("speed_droop", [3], IN)),
         Score("named", (False,), (False,), ("speed_droop",), 9, 0, ()), "speed_droop"),
        (scaled(3), answer("named", ("wheel_radius_scale", [4], IN)),
         Score("named", (False,), (False,), ("wheel_radius_scale",), 9, 1, ()),
         "wheel_radius_scale"),
        (scaled(3), answer("named", ("wheel_radius_scale", "all", IN)),
         Score("named", (False,), (True,), ("wheel_radius_scale",), 9, 9, ()),
         "wheel_radius_scale"),
        (scaled(3), answer("ambiguous", ("speed_droop", [3], IN), rivals=("wheel_radius_scale",)),
         Score("ambiguous", (False,), (True,), (), 9, 0, ()), "ambiguous"),
        (scaled(3), answer("ambiguous", ("speed_droop", [3], IN), rivals=("motor_lag",)),
         Score("ambiguous", (False,), (False,), ("speed_droop",), 9, 0, ()), "speed_droop"),
        (scaled(), answer("named", ("wheel_radius_scale", "all", IN)),
         Score("named", (True,), (False,), (), 0, 0, (True,)), "wheel_radius_scale"),
        (scaled(), answer("named", ("wheel_radius_scale", [1, 2], IN)),
         Score("named", (False,), (True,), (), 0, 0, ()), "ambiguous"),
        (scaled(3), None, Score("failed", (False,), (False,), (), 9, 0, ()), "failed"),
    ],
)  # fmt: skip
def test_a_diagnosis_is_scored_by_name_robots_and_interval(
    hidden: Hidden, said: dict[str, Any] | None, expected: Score, word: str
) -> None:
    one = trial(hidden)
    assert score(one, said) == expected
    assert outcome(one, expected) == word


def test_the_right_name_for_the_other_wheel_is_wrong() -> None:
    left = Hidden("motor_saturation", {"limit": 4.0, "wheel": "left"}, (3,), 0.36, 3.6)
    said = answer("named", ("motor_saturation", [3], IN))
    said["causes"][0]["parameters"] = {"wheel": {"value": "right", "unit": "word"}}
    assert score(trial(left), said).wrong == ("motor_saturation",)
    said["causes"][0]["parameters"]["wheel"]["value"] = "left"
    assert score(trial(left), said).right == (True,)


def test_a_name_on_a_healthy_run_is_wrong_and_accuses_its_robots() -> None:
    found = score(trial(), answer("named", ("motor_lag", [2], IN), ("motor_lag", [5], IN)))
    assert (found.wrong, found.accused, found.healthy) == (("motor_lag", "motor_lag"), 2, 10)


def test_a_pair_is_exact_when_both_are_named_and_nothing_else() -> None:
    both = trial(scaled(3), Hidden("motor_lag", {"time_constant": 0.1}, (4,), 0.1, 4.0))
    right = (("wheel_radius_scale", [3], IN), ("motor_lag", [4], IN))
    assert score(both, answer("named", *right)).exact
    assert not score(both, answer("named", right[0])).exact
    assert not score(both, answer("named", *right, ("speed_droop", [3], IN))).exact


def named_with(limit: float, seconds: float, random: np.random.Generator) -> tuple[float, bool]:
    """A trial of a diagnosis that names 95 % at a limit that falls with the root of the length."""
    multiple = 4.0 ** random.uniform(-1.0, 1.0)
    logit = 2.944 + 5.0 * np.log(multiple / (limit * (120.0 / seconds) ** 0.5))
    return multiple, bool(random.random() < 1.0 / (1.0 + np.exp(-logit)))


def test_a_limit_is_found_with_an_interval_that_holds_it() -> None:
    random = np.random.default_rng(4)
    seconds = random.choice([60.0, 120.0, 240.0], 400).tolist()
    trials = [named_with(1.4, s, random) for s in seconds]
    limit = detection_limit([m for m, _ in trials], seconds, [hit for _, hit in trials], random)
    assert limit is not None
    assert limit.low < 1.4 < limit.high
    assert limit.high / limit.low < 2.0
    assert limit.per_doubling == pytest.approx(2.0**-0.5, abs=0.15)
    assert limit.beyond == ""


def test_what_is_never_or_always_named_has_its_limit_beyond_the_sizes_tried() -> None:
    multiples = np.geomspace(0.25, 4.0, 12).tolist()
    random = np.random.default_rng(1)
    never = detection_limit(multiples, [120.0] * 12, [False] * 12, random)
    always = detection_limit(multiples, [120.0] * 12, [True] * 12, random)
    assert never is not None
    assert always is not None
    assert (never.beyond, always.beyond) == ("above", "below")
    assert detection_limit([1.0], [120.0], [True], random) is None


def test_shares_carry_exact_intervals() -> None:
    assert share(0, 0)["share"] is None
    assert share(3, 100) == {"hits": 3, "trials": 100, "share": 0.03, "low": 0.0062, "high": 0.0852}


@pytest.fixture(scope="module")
def battery(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    out = tmp_path_factory.mktemp("blind") / "battery"
    config = blind_config(trials=7, seed=2, **SMALL)
    return out, run_battery(config, out, Workers(1), quiet=True, diagnosed=STUB)


def test_a_battery_scores_what_a_process_with_the_log_alone_answered(
    battery: tuple[Path, dict[str, Any]],
) -> None:
    out, summary = battery
    assert summary["failed"] == []  # the stub refuses a directory with anything beside the log
    assert summary["trials"] == 7
    assert summary["confusion"]["nothing"] == {"nothing_wrong": 1}
    assert summary["confusion"]["ls_dead_sensor"] == {"ls_dead_sensor": 2}
    assert summary["confusion"]["command_latency"] == {"nothing_wrong": 2}
    assert summary["wrong_names"]["hits"] == 0
    assert summary["unlisted"]["flagged_unexplained"]["hits"] == 0
    assert [one["follows"] for one in summary["unlisted"]["answers"]] == [
        "left_wheel_angle right_wheel_angle"
    ]
    assert json.loads((out / "blind.json").read_text()) == summary
    page = (out / "report.html").read_text()
    assert "data:image/png;base64" in page
    assert "http" not in re.sub(r"http-equiv", "", page)


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_the_page_fits_phone_and_desk(battery: tuple[Path, dict[str, Any]], tmp_path: Path) -> None:
    check_fits(battery[0] / "report.html", tmp_path)


def test_nothing_in_the_log_tells_what_was_hidden(tmp_path: Path) -> None:
    from realitygap.studies.run.experiment import simulate

    hidden = Hidden("command_latency", {"seconds": 0.1234}, (1,), 0.1234, 3.0)
    simulate(RunConfig(minutes=0.02, robots=3), (hidden.spec,), tmp_path)
    for name in ("samples.parquet", "run.json"):
        content = (tmp_path / name).read_bytes()
        assert b"latency" not in content
        assert b"0.1234" not in content
    assert b"latency" in (tmp_path / "truth.json").read_bytes()


def test_a_log_that_is_diagnosed_does_not_say_what_kind_of_run_it_is(tmp_path: Path) -> None:
    """Of the run's column, and of any other text in the file but the light."""
    one = plan(blind_config(trials=1, seed=7, **SMALL))[0]
    record(one.run, one.specs, tmp_path / "samples.parquet")
    schema = pq.read_schema(tmp_path / "samples.parquet")
    assert schema.metadata == {RECORDER: f"reality {one.run.engine}".encode()}
    table = pd.read_parquet(tmp_path / "samples.parquet")
    texts = {name for name in table if not pd.api.types.is_numeric_dtype(table[name])}
    assert texts == {"run", "case"}
    assert set(table["run"]) == {"log"}
    assert set(table["case"]) == {one.run.case}


def test_damaged_and_foreign_trials_are_made_anew_and_said(
    battery: tuple[Path, dict[str, Any]], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = shutil.copytree(battery[0], tmp_path / "battery")
    trials = out / "trials"
    cut = trials / "00001" / "trial.json"
    cut.write_bytes(cut.read_bytes()[:200])
    shutil.rmtree(trials / "00002")
    shutil.copytree(trials / "00003", trials / "00002")
    config = blind_config(trials=7, seed=2, **SMALL)
    again = run_battery(config, out, Workers(1), diagnosed=STUB)
    said = [line for line in capfd.readouterr().err.splitlines() if "made anew" in line]
    assert said == [
        "trial 00001 is made anew: its trial.json is not as it was written",
        "trial 00002 is made anew: it is another's, with index 3, not 2",
    ]
    seconds = {"diagnose_seconds": None}
    assert again | seconds == battery[1] | seconds


def test_a_resumed_battery_repeats_nothing_and_may_grow(
    battery: tuple[Path, dict[str, Any]],
) -> None:
    out, summary = battery
    before = {path: path.stat().st_mtime_ns for path in (out / "trials").glob("*/*")}
    grown = blind_config(trials=8, seed=2, **SMALL)
    again = run_battery(grown, out, Workers(1), quiet=True, diagnosed=STUB)
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert again["trials"] == 8
    fewer = blind_config(trials=7, seed=2, **SMALL)
    assert run_battery(fewer, out, Workers(1), quiet=True, diagnosed=STUB) == summary


def test_another_seed_is_refused_in_the_same_directory(
    battery: tuple[Path, dict[str, Any]],
) -> None:
    with pytest.raises(InputError, match="seed 2 there, 3 now"):
        run_battery(blind_config(trials=7, seed=3, **SMALL), battery[0], Workers(1), diagnosed=STUB)


def test_a_diagnosis_that_fails_is_a_result_and_not_the_end(tmp_path: Path) -> None:
    command = (sys.executable, "-c", "import sys; sys.exit('out of ideas')")
    config = blind_config(trials=2, seed=2, **SMALL)
    failing = partial(diagnose, command=command)
    summary = run_battery(config, tmp_path / "b", Workers(1), quiet=True, diagnosed=failing)
    assert summary["failed"] == [
        "00000: exit code 1: out of ideas",
        "00001: exit code 1: out of ideas",
    ]
    assert summary["confusion"]["ls_dead_sensor"] == {"failed": 1}


@pytest.mark.parametrize(
    ("words", "field"),
    [
        (("--trials", "0"), "--trials"),
        (("--only", "motor_lagg"), "--only"),
        (("--seed", "-1"), "--seed"),
        (("--jobs", "0"), "--jobs"),
    ],
)
def test_words_that_cannot_be_used_are_refused_before_anything_is_written(
    words: tuple[str, ...], field: str, tmp_path: Path
) -> None:
    from typer.testing import CliRunner

    from realitygap.studies.cli import app

    out = tmp_path / "out"
    error = CliRunner().invoke(app, ["blind", *words, "--out", str(out)]).exception
    assert isinstance(error, InputError)
    assert error.field == field
    assert not out.exists()


def test_a_directory_with_other_things_in_it_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match="new or empty directory"):
        run_battery(blind_config(trials=1, **SMALL), tmp_path, Workers(1), diagnosed=STUB)


def test_a_crowd_gives_each_robot_an_effect_and_each_effect_its_own_score(tmp_path: Path) -> None:
    effects = ("ls_dead_sensor", "command_latency", "floor_tilt", "motor_lag", "ls_dead_sensor")
    config = blind_config(trials=2, seed=3, effects=effects, at_bars=True, crowd=3, robots=5,
                          seconds=(2.0,))  # fmt: skip
    first, second = plan(config)
    assert [one.name for one in first.hidden] == ["ls_dead_sensor", "command_latency"]
    assert len({one.robots for one in first.hidden}) == 2
    assert [one.name for one in second.hidden] == ["floor_tilt"]
    grown = config.model_copy(update={"trials": 3})
    assert [one.name for one in plan(grown)[2].hidden] == [
        "motor_lag",
        "ls_dead_sensor",
        "ls_dead_sensor",
    ]
    summary = run_battery(grown, tmp_path / "b", Workers(1), quiet=True, diagnosed=STUB)
    assert summary["confusion"]["ls_dead_sensor"] == {"ls_dead_sensor": 3}
    assert summary["confusion"]["motor_lag"] == {"nothing_wrong": 1}
    assert summary["wrong_names"]["hits"] == 0
    assert summary["healthy_robots_accused"]["trials"] == 3 + 2


def test_of_a_crowd_only_what_is_said_of_a_robot_counts_for_it() -> None:
    said = answer("ambiguous", ("motor_lag", [2], IN), ("speed_droop", [4, 5], IN))
    said["causes"][1]["alternatives"] = ["wheel_radius_scale"]
    said["unexplained"] = [{"channel": "yaw", "where": "at starts", "robots": [7]}]
    assert of_robots(said, {3})["verdict"] == "nothing_wrong"
    assert [c["robots"] for c in of_robots(said, {4})["causes"]] == [[4]]
    assert named(of_robots(said, {4}), 10)[0].rivals == ("wheel_radius_scale",)
    assert named(of_robots(said, {2}), 10)[0].rivals == ()
    said["causes"].append({"name": "motor_lag", "robots": "all", "parameters": {}})
    assert [c["robots"] for c in of_robots(said, {3})["causes"]] == ["all"]
    assert of_robots(said, {3}, swarm=False)["causes"] == []
    said["causes"].pop()
    said["verdict"] = "unexplained"
    assert of_robots(said, {7})["verdict"] == "unexplained"
    assert of_robots(said, {3})["verdict"] == "nothing_wrong"

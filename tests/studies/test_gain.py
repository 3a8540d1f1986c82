"""`realitygap gain`: what naming a cause is worth on runs that nothing was named from."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.belief.modelfile import ModelFile, load_model, read_model_file
from realitygap.models.log.measured import make_log, write_table
from realitygap.models.naming.claims.prediction import prediction_errors
from realitygap.reality.effects import parse_effects
from realitygap.studies.gain.food import food_lines, food_table, read_transfer
from realitygap.studies.gain.held_out import true_model
from realitygap.studies.gain.measure import gain
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE, plan
from realitygap.studies.gain.weigh import entry, weigh
from realitygap.studies.inputs.logs import log_hash
from realitygap.studies.inputs.model import Model
from realitygap.studies.measure.gain import groups
from tests.helpers import realitygap
from tests.models.small import arena_log

EPUCK = read_model_file("epuck")
TABLES = load_model("epuck").tables
RATIO = Drive(wheel_radius=(0.0205 / 1.03, 0.0205 * 1.03))


def ratio(value: float, robots: object = (1,)) -> NamedCause:
    parameters = {"ratio": ParameterValue(value=value, unit="right/left")}
    return NamedCause(name="wheel_radius_mismatch", robots=robots, parameters=parameters)


def with_causes(*causes: NamedCause, log: str = "") -> ModelFile:
    return EPUCK.model_copy(update={"extension": Extension(log=log, causes=causes)})


def recording(seed: int, run: str, *, odd: Drive = RATIO) -> pd.DataFrame:
    """Three robots of which robot 1 has another drive."""
    parts = [
        arena_log(seed + k, robots=1, rows=1500, drive=odd if k == 1 else None, sensors=TABLES)
        for k in range(3)
    ]
    frames = [part.assign(robot=k, run=run) for k, part in enumerate(parts)]
    return pd.concat(frames, ignore_index=True)


def in_a_lab(room: Path, *causes: NamedCause) -> tuple[Path, Path, Path]:
    """A log that an extension was named from, a later one of four runs, and the extension."""
    first, later = room / "first.parquet", room / "later.parquet"
    write_table(recording(10, "a"), first)
    runs = [recording(100 * k, f"r{k}") for k in range(1, 5)]
    write_table(pd.concat(runs, ignore_index=True), later)
    named = Extension(log=log_hash(first), command="by hand", causes=causes)
    Model.load("epuck").extended(named).keep(room)
    return first, later, room / "extended.toml"


def test_the_true_model_predicts_as_well_as_noise_allows_and_the_minimal_one_does_not() -> None:
    log = make_log(recording(3, "a"), drive=Drive())
    table = prediction_errors(log, {BEFORE: EPUCK, EXTENDED: with_causes(ratio(1.0609))}, TABLES)
    sums = table.groupby(["robot", "model", "channel", "horizon"])[["total", "number"]].sum()
    mean = sums["total"] / sums["number"]
    for channel in ("position", "heading"):
        wrong, right = mean[1, BEFORE, channel, "1 s"], mean[1, EXTENDED, channel, "1 s"]
        assert right == pytest.approx(mean[0, BEFORE, channel, "1 s"], rel=0.2)
        assert wrong > 1.5 * right
    assert mean[0, BEFORE, "heading", "1 s"] == mean[0, EXTENDED, "heading", "1 s"]
    assert mean[0, BEFORE, "ls0", ""] == mean[0, EXTENDED, "ls0", ""]
    # poses are averaged along the motion believed, and so differ a little
    assert mean[1, BEFORE, "ls0", ""] == pytest.approx(mean[1, EXTENDED, "ls0", ""], rel=0.01)


def test_every_model_is_asked_the_same() -> None:
    log = make_log(recording(3, "a"), drive=Drive())
    models = {BEFORE: EPUCK, EXTENDED: with_causes(ratio(1.05))}
    table = prediction_errors(log, models, TABLES)
    keys = ["kind", "channel", "horizon", "robot", "block", "stratum"]
    numbers = table.set_index([*keys, "model"])["number"].unstack("model")
    assert (numbers[BEFORE] == numbers[EXTENDED]).all()


def test_dead_sensors_are_predicted_by_whom_they_concern() -> None:
    frame = recording(3, "a")
    frame.loc[frame["robot"] == 2, "ls0"] = TABLES.counts_max
    cause = NamedCause(name="ls_dead_sensor", robots=(2,), word="0", parameters={})
    models = {BEFORE: EPUCK, EXTENDED: with_causes(cause)}
    table = prediction_errors(make_log(frame, drive=Drive()), models, TABLES)
    ls0 = table[table["channel"] == "ls0"].groupby(["robot", "model"])["total"].sum()
    assert ls0[2, EXTENDED] < 0.05 * ls0[2, BEFORE]
    assert ls0[0, EXTENDED] == ls0[0, BEFORE]


def table_of(errors: dict[str, list[float]]) -> pd.DataFrame:
    """Runs with a given mean error by model, a hundred windows each."""
    rows = [
        {"model": model, "run": str(k), "robot": 0, "block": 0, "total": 100 * e, "number": 100}
        for model, values in errors.items()
        for k, e in enumerate(values)
    ]
    labels = {"kind": "motion", "channel": "position", "horizon": "1 s", "unit": "m"}
    return pd.DataFrame(rows).assign(stratum=0, **labels)


def test_healthy_robots_are_taken_in_situations_as_frequent_as_the_others() -> None:
    """A robot that turns three quarters of its time, healthy ones that turn a quarter of theirs."""
    situations = [(BEFORE, 0, 1.0, 25), (BEFORE, 1, 9.0, 75), (HEALTHY, 0, 1.0, 75)]
    situations += [(HEALTHY, 1, 9.0, 25), (EXTENDED, 0, 1.0, 25), (EXTENDED, 1, 9.0, 75)]
    rows = [
        {"model": model, "run": str(run), "robot": 0, "block": 0, "stratum": stratum}
        | {"total": error * number, "number": number}
        for model, stratum, error, number in situations
        for run in range(5)
    ]
    labels = {"kind": "motion", "channel": "position", "horizon": "1 s", "unit": "m"}
    found = entry(weigh(pd.DataFrame(rows).assign(**labels)), "position", "1 s")
    assert found[BEFORE]["value"] == pytest.approx(7.0)
    assert found[HEALTHY]["value"] == pytest.approx(7.0)
    assert found["closed"] is None


def test_the_share_closed_is_of_what_is_beyond_healthy_robots() -> None:
    errors = {BEFORE: [5.0] * 6, HEALTHY: [1.0] * 6, EXTENDED: [1.4] * 6, ORACLE: [1.2] * 6}
    found = entry(weigh(table_of(errors)), "position", "1 s")
    assert found["closed"]["value"] == pytest.approx(0.9)
    assert found["over_healthy"]["value"] == pytest.approx(1.4)
    assert found["remains"]["value"] == pytest.approx(0.4)
    assert found["number"] == 600


def test_intervals_come_from_whole_runs() -> None:
    before = list(np.random.default_rng(1).normal(5.0, 1.0, 40))
    found = entry(weigh(table_of({BEFORE: before, EXTENDED: before})), "position", "1 s")
    width = found[BEFORE]["high"] - found[BEFORE]["low"]
    assert width == pytest.approx(2 * 1.96 * np.std(before) / np.sqrt(40), rel=0.15)


def test_where_nothing_is_beyond_healthy_robots_no_share_is_stated() -> None:
    noisy = np.random.default_rng(0).normal(1.0, 0.3, (2, 6)).tolist()
    errors = {BEFORE: noisy[0], HEALTHY: noisy[1], EXTENDED: noisy[0]}
    assert entry(weigh(table_of(errors)), "position", "1 s")["closed"] is None


def test_the_true_parameters_are_those_of_the_effects() -> None:
    specs = ("motor_saturation:limit=4,wheel=left,robot=2", "lamp_moved:x=0.1,y=-0.2")
    true = true_model(EPUCK, parse_effects(specs, 4))
    assert true is not None
    assert true.motion(2).drive.speed_limit == (4.0, np.inf)
    assert true.motion(1) == EPUCK.motion()
    assert true.point_model(TABLES).senses.lamp_shift == (0.1, -0.2)
    assert true_model(EPUCK, parse_effects(("floor_tilt:slope=0.02",), 4)) is None


def test_held_out_runs_are_other_runs_and_the_twins_have_the_same_seeds() -> None:
    settings = {"runs": 7, "minutes": 1.0, "robots": 10, "seed": 3}
    altered, twins = plan(("motor_lag:time_constant=0.1",), **settings), plan((), **settings)
    seeds = [run.config.seed for run in altered]
    assert len(set(seeds)) == 7
    assert [run.config for run in altered] == [run.config for run in twins]
    assert seeds != [run.config.seed for run in plan((), **{**settings, "seed": 4})]
    assert any(run.config.controller.startswith("probe:") for run in altered)
    assert len({(run.config.controller, run.config.case) for run in altered}) == 6


def test_a_lab_measures_on_runs_that_nothing_was_named_from(tmp_path: Path) -> None:
    first, later, extended = in_a_lab(tmp_path, ratio(1.0609))
    found = gain([first, later], extended, jobs=1)
    content = found.content
    runs = [{"run": str(later), "notes": []}]
    assert content["held_out"] == {"source": "logs", "runs": runs, "robots": [1]}
    assert content["healthy"] == "other robots"
    assert content["oracle"] is False
    read = [(one["option"], one["file"]) for one in content["inputs"]]
    assert read[:2] == [("--log", str(first)), ("--log", str(later))]
    assert read[2] == ("--extended", str(extended))
    assert content["inputs"][0]["sha256"] == log_hash(first)
    heading = entry(content["errors"], "heading", "1 s")
    assert heading[ORACLE] is None
    assert heading["closed"]["value"] > 0.8
    assert heading["over_healthy"]["value"] == pytest.approx(1.0, abs=0.2)
    out = tmp_path / "out"
    found.write(out)
    assert json.loads((out / "gain.json").read_text())["schema"] == 1
    assert any("not known" in line for line in found.summary)
    page = (out / "report.html").read_text()
    assert "wheel_radius_mismatch" in page
    assert "over blocks of 5 s of each robot" in page, "there is one run"
    assert "over runs" not in page
    assert "Grey" in page, "a healthy level is drawn"
    assert "http" not in page.replace("http-equiv", "")


def test_one_job_on_a_labs_logs_starts_no_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that a script needs no guard."""
    first, later, extended = in_a_lab(tmp_path, ratio(1.0609))
    two = gain([first, later], extended, jobs=2)
    monkeypatch.setattr("multiprocessing.process.BaseProcess.start", None)
    assert gain([first, later], extended, jobs=1).content["errors"] == two.content["errors"]


def test_the_log_that_was_named_from_is_not_held_out(tmp_path: Path) -> None:
    first, _, extended = in_a_lab(tmp_path, ratio(1.0609))
    done = realitygap("gain", "--log", first, "--extended", extended, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "not named from" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("causes", "change", "said"),
    [
        ((), {"extended": "epuck"}, r"\[extension\]"),
        ((), {"effects": ("motor_lagg:x=1",)}, "did you mean motor_lag"),
        ((ratio(1.02, (7,)),), {}, "robots: got 7"),
        ((ratio(1.02),), {"log": Path("nowhere.csv")}, "--log"),
    ],
)
def test_what_cannot_be_measured_is_refused(
    causes: tuple[NamedCause, ...], change: dict[str, object], said: str, tmp_path: Path
) -> None:
    _, later, extended = in_a_lab(tmp_path, *causes)
    words = {"log": later, "extended": extended, "jobs": 1, **change}
    with pytest.raises(InputError, match=said):
        gain(**words)


def test_effects_other_than_what_was_hidden_are_refused(tmp_path: Path) -> None:
    first, _, extended = in_a_lab(tmp_path, ratio(1.0609))
    run = tmp_path / "run"
    run.mkdir()
    first.rename(run / "samples.parquet")
    (run / "truth.json").write_text('{"effects": []}')
    effects = ("motor_lag:time_constant=0.1,robot=1",)
    with pytest.raises(InputError, match="--effect"):
        gain(run, extended, effects=effects)


@pytest.mark.parametrize("name", ["run.json", "truth.json"])
@pytest.mark.parametrize("content", ["", "[]", "[" * 100_000, '{"effects": 3, "config": 3}'])
def test_damaged_notes_beside_a_log_are_one_clear_line(
    name: str, content: str, tmp_path: Path
) -> None:
    first, _, extended = in_a_lab(tmp_path, ratio(1.0609))
    run = tmp_path / "run"
    run.mkdir()
    first.rename(run / "samples.parquet")
    (run / name).write_text(content)
    effects = ("wheel_radius_mismatch:ratio=1.0609,robot=1",)
    with pytest.raises(InputError, match=f"the {name} of a run"):
        gain(run, extended, effects=effects)


def test_every_effect_of_the_catalogue_is_hidden_once_at_the_size_asked_for() -> None:
    names = ("motor_lag", "ir_gain", "lamp_moved", "ls_dead_sensor")
    planned = groups(names, times=2.0, runs=6, minutes=1.0, seed=1, draws=1)
    assert sorted(one.name for group in planned for one in group.hidden) == sorted(names)
    own = [one.robots for one in planned[0].hidden]
    assert len(own) == len(set(own)) == 3
    lag = next(one for one in planned[0].hidden if one.name == "motor_lag")
    assert lag.size == pytest.approx(0.05)


def test_the_gain_in_food_is_taken_from_a_finished_study(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="study transfer"):
        read_transfer(tmp_path)
    found = {"metric": "food", "first": "extended", "second": "minimal", "verdict": "more"}
    found |= {"mean_first": 30.0, "mean_second": 20.0, "difference": 10.0, "low": 5.0, "high": 15.0}
    alteration = {"label": "a window", "reason": "it pays", "comparisons": [found]}
    content = {"schema": 1, "configuration": {}, "alterations": [alteration]}
    (tmp_path / "transfer.json").write_text(json.dumps(content))
    food = read_transfer(tmp_path)
    assert food_table(food)["difference"].tolist() == [10.0]
    assert "1 more, 0 not shown, 0 less" in food_lines(food)[0]


@pytest.mark.slow
def test_a_cause_that_was_named_closes_the_gap_on_fresh_runs(tmp_path: Path) -> None:
    effect = "wheel_radius_mismatch:ratio=1.03,robot=1"
    for words in (
        f"run --minutes 2 --out odd --effect {effect}",
        "diagnose odd --out named",
        f"gain --log odd --extended named/extended.toml --out gain --effect {effect}",
    ):
        done = realitygap(*words.split(), cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    content = json.loads((tmp_path / "gain" / "gain.json").read_text())
    found = entry(content["errors"], "heading", "1 s")
    assert found["closed"]["value"] > 0.8
    assert found[ORACLE] is not None
    assert content["healthy"] == "twins"
    assert any(run["like_the_naming_run"] is False for run in content["held_out"]["runs"])

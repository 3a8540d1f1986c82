"""What `import realitygap` gives: the commands as functions, their results as objects."""

from __future__ import annotations

import ast
import dataclasses
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import realitygap as rg
from realitygap.embedded_sim import Drive
from realitygap.models.belief.catalogue import causes as motion_causes
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.log.measured import write_table
from realitygap.reality.effects import catalogue
from tests.helpers import ROOT, realitygap
from tests.models.small import driven_log
from tests.test_package import python

ODD = Drive(wheel_radius=(0.0202, 0.0208))
ROBOT = "wheel_radius = 0.0205\naxle = 0.053\nbody_radius = 0.035\nwheel_speed_max = 6.28\n"


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot in the open with unequal wheels: log.csv and open.toml."""
    room = tmp_path_factory.mktemp("door")
    frame = driven_log(3, robots=1, rows=700, drive=ODD, position_noise=5e-4, heading_noise=5e-3)
    write_table(frame, room / "log.csv")
    (room / "open.toml").write_text(f'name = "a robot in the open"\n[robot]\n{ROBOT}')
    return room


@pytest.fixture(scope="module")
def found(room: Path) -> rg.DiagnosisResult:
    return rg.diagnose(room / "log.csv", model=room / "open.toml")


def test_other_rules_give_another_answer_which_says_so(
    room: Path, found: rg.DiagnosisResult
) -> None:
    deaf = rg.Rules(cause_gate=1e9, flexible_gate=1e9)
    other = rg.diagnose(room / "log.csv", model=room / "open.toml", rules=deaf)
    assert len(found.causes) > 0
    assert len(other.causes) == 0
    assert other.content["rules"] == {"cause_gate": 1e9, "flexible_gate": 1e9}
    assert "rules" not in found.content


def test_the_names_of_the_door_are_listed_typed_and_there() -> None:
    source = ast.parse((ROOT / "realitygap" / "__init__.py").read_text(encoding="utf-8"))
    (typed,) = (node for node in source.body if isinstance(node, ast.If))
    names = {
        alias.asname or alias.name
        for node in typed.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert names == set(rg.__all__) == set(dir(rg))
    assert all(getattr(rg, name) is not None for name in names)
    with pytest.raises(AttributeError, match="no attribute 'diagnoze'"):
        getattr(rg, "diagnoze")  # noqa: B009 - a type checker would refuse it


def test_the_door_opens_without_loading_what_lies_behind(tmp_path: Path) -> None:
    code = "import sys, realitygap; print('numpy' in sys.modules, 'typer' in sys.modules)"
    assert python(code, tmp_path).stdout.split() == ["False", "False"]


@pytest.mark.parametrize("name", rg.__all__)
def test_every_function_and_result_says_what_it_is(name: str) -> None:
    text = getattr(rg, name).__doc__
    assert text
    if callable(getattr(rg, name)) and not isinstance(getattr(rg, name), type):
        assert "Args:" in text or "Columns" in text


def test_a_function_writes_what_its_command_writes(
    room: Path, found: rg.DiagnosisResult, tmp_path: Path
) -> None:
    words = ("diagnose", room / "log.csv", "--model", room / "open.toml")
    done = realitygap(*words, "--out", tmp_path / "by-command")
    assert done.returncode == 0, done.stderr
    assert found.sentence in done.stdout
    found.write(tmp_path / "by-function")
    files = sorted(path.name for path in (tmp_path / "by-command").iterdir())
    assert files == ["diagnosis.json", "extended.toml", "report.html"]
    for name in files:
        same = [(tmp_path / by / name).read_bytes() for by in ("by-command", "by-function")]
        assert same[0] == same[1], name


def test_a_diagnosis_is_tables_a_model_and_a_few_lines(
    room: Path, found: rg.DiagnosisResult
) -> None:
    causes = found.causes.set_index("cause")
    assert causes.loc["wheel_radius_mismatch", "parameter"] == "ratio"
    assert causes["value"].dtype == float
    assert list(found.extended.causes["cause"]) == list(causes.index[causes["exported"]])
    assert set(found.detectable["cause"]) <= set(motion_causes())
    assert set(found.gain["prediction"]) >= {"position_1s", "heading_1s"}
    assert (found.gain["after"] < found.gain["before"]).all()
    assert found.used["used"].between(0.5, 1.0).all()
    assert repr(found).startswith(f"Diagnosis: {found.verdict}\n")
    assert "wheel_radius_mismatch" in repr(found)
    assert max(map(len, repr(found).splitlines())) <= 100
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.command = "another"  # type: ignore[misc]


def test_a_log_is_a_path_a_table_or_what_was_read(room: Path, found: rg.DiagnosisResult) -> None:
    frame, model = pd.read_csv(room / "log.csv"), rg.Model.load(room / "open.toml")
    for given in (str(room / "log.csv"), frame, rg.read_log(frame, model=model)):
        same = rg.diagnose(given, model=model)
        pd.testing.assert_frame_equal(same.causes, found.causes)
    read = rg.read_log(room / "log.csv", model=model)
    assert rg.diagnose(read).content == found.content  # a log keeps the model it was read by
    assert (read.robots, read.runs, len(read.table)) == ((0,), ("a",), 700)
    assert "700 rows" in repr(read)


def test_a_table_in_memory_is_told_by_its_content(room: Path) -> None:
    frame, model = pd.read_csv(room / "log.csv"), room / "open.toml"
    found = rg.diagnose(frame, model=model)
    first = found.content["inputs"][0]
    assert (first["option"], first["file"]) == ("LOG", "<table>")
    assert found.extended.file.extension is not None
    assert found.extended.file.extension.log == first["sha256"]
    with pytest.raises(rg.InputError, match="not named from"):
        rg.gain(frame.copy(), found.extended, jobs=1)
    changed = frame.assign(x=frame["x"] + 1e-9)
    assert rg.diagnose(changed, model=model).content["inputs"][0]["sha256"] != first["sha256"]


def test_several_logs_are_one_log_of_several_runs(room: Path) -> None:
    frame = pd.read_csv(room / "log.csv")
    both = rg.read_log([frame, frame.assign(x=frame["x"] + 1.0)], model=room / "open.toml")
    assert both.runs == ("1/a", "2/a")
    with pytest.raises(rg.InputError, match="the same log as"):
        rg.read_log([room / "log.csv", room / "log.csv"])


def test_a_gain_is_measured_without_any_file(room: Path, found: rg.DiagnosisResult) -> None:
    later = [
        driven_log(seed, robots=1, rows=700, drive=ODD, position_noise=5e-4, heading_noise=5e-3)
        for seed in (8, 9)
    ]
    gained = rg.gain([frame.assign(run=f"r{k}") for k, frame in enumerate(later)], found.extended)
    heading = gained.errors.set_index(["channel", "horizon"]).loc[("heading", "1 s")]
    assert heading["extended_high"] < heading["before_low"]
    assert gained.content["inputs"][2]["file"] == "extended.toml"
    assert repr(gained).startswith("Gain\n")
    assert set(gained.by_run["run"]) == {"1/<table>", "2/<table>"}


def test_a_gap_is_tables_and_sentences(room: Path, tmp_path: Path) -> None:
    gap = rg.measure_gap(room / "log.csv", model=room / "open.toml", out=tmp_path / "gap")
    assert gap.flagged
    written = json.loads((tmp_path / "gap" / "gap.json").read_text())
    assert tuple(written["summary"]) == gap.summary
    for name, table in gap.tables.items():
        assert len(pd.read_parquet(tmp_path / "gap" / f"{name}.parquet")) == len(table)
    assert set(gap.horizons["horizon"]) >= {"step", "1 s"}
    shares = gap.channels[["noise", "bias", "structured"]].sum(axis=1)
    assert np.allclose(shares, 1.0)


def test_replay_tells_where_the_model_says_a_robot_was(room: Path) -> None:
    frame = driven_log(3, robots=2, rows=400, drive=ODD)
    nominal = rg.replay(frame, model=room / "open.toml", horizon=1.0)
    assert nominal["heading"].abs().max() > 0.01
    assert np.allclose(nominal["t"] - nominal["t_start"], 1.0, atol=0.05)
    cause = NamedCause(
        name="wheel_radius_mismatch",
        parameters={"ratio": ParameterValue(value=ODD.wheel_radius[1] / ODD.wheel_radius[0])},
    )
    size = NamedCause(
        name="wheel_radius_scale",
        parameters={"scale": ParameterValue(value=np.mean(ODD.wheel_radius) / 0.0205)},
    )
    true = rg.Model.load(room / "open.toml").extended(Extension(causes=(cause, size)))
    whole = rg.replay(frame, model=true)
    assert len(whole) == len(frame) - 2
    assert whole[["along", "across", "heading"]].abs().max().max() < 1e-3
    measured = frame.sort_values(["robot", "t"]).groupby("robot").tail(1)
    assert np.allclose(whole.groupby("robot").tail(1)["x"], measured["x"], atol=1e-3)


def test_a_run_is_in_memory_or_on_the_disk_and_the_same(tmp_path: Path) -> None:
    asked = {"minutes": 0.1, "robots": 2, "seed": 3, "controller": "search"}
    held = rg.simulate(**asked, effects=("motor_lag:time_constant=0.1,robot=1",))
    kept = rg.simulate(
        **asked, effects=("motor_lag:time_constant=0.1,robot=1",), out=tmp_path / "run"
    )
    for name in ("generations", "deposits", "samples"):
        pd.testing.assert_frame_equal(getattr(held, name), getattr(kept, name))
    assert held.totals.keys() == {"deposits", "radio_messages", "wall_seconds"}
    assert held.log().robots == kept.log().robots == (0, 1)
    assert "2 robots for 0.1 min" in repr(held)
    blind = rg.simulate(**asked, samples=False)
    with pytest.raises(KeyError, match="samples"):
        blind.samples  # noqa: B018


def test_an_extended_model_goes_on_board_before_it_is_written(tmp_path: Path) -> None:
    cause = NamedCause(
        name="wheel_separation", robots=(1,), parameters={"scale": ParameterValue(value=1.3)}
    )
    extended = rg.Model.load().extended(Extension(causes=(cause,)))
    assert "in memory" in repr(extended)
    written = extended.write(tmp_path / "model")
    asked = {"minutes": 0.05, "robots": 2, "seed": 1}
    for name, model in (("memory", extended), ("disk", written)):
        rg.simulate(**asked, model=model, out=tmp_path / name)
    memory, disk = (
        json.loads((tmp_path / name / "run.json").read_text()) for name in ("memory", "disk")
    )
    assert memory["config"]["model"] == "extended.toml"
    assert disk["config"]["model"] == str(tmp_path / "model" / "extended.toml")
    assert [one["sha256"] for one in memory["inputs"]] == [one["sha256"] for one in disk["inputs"]]
    samples = [pd.read_parquet(tmp_path / name / "samples.parquet") for name in ("memory", "disk")]
    pd.testing.assert_frame_equal(*samples)
    with pytest.raises(rg.InputError, match="robots: got 1"):
        rg.simulate(robots=1, model=extended)


def test_the_catalogues_are_whole() -> None:
    effects, causes = rg.effects(), rg.causes()
    assert sorted(effects["effect"]) == sorted(catalogue())
    assert list(causes["cause"].unique()) == list(every_cause())
    lag = causes.set_index("cause").loc["motor_lag"]
    assert (lag["parameter"], lag["unit"], lag["null"]) == ("time_constant", "s", 0.0)


def test_a_labs_format_is_read_and_written(tmp_path: Path) -> None:
    example = ROOT / "docs" / "example"
    words = {"format": "csv", "map": example / "map.toml", "model": example / "robot.toml"}
    log = rg.read_log(example / "log.csv", **words)
    log.write(tmp_path / "log.parquet")
    again = rg.read_log(tmp_path / "log.parquet", model=log.model)
    pd.testing.assert_frame_equal(again.table[list(log.table)], log.table, check_dtype=False)
    imported = rg.import_log(example / "log.csv", **words, out=tmp_path / "imported.parquet")
    pd.testing.assert_frame_equal(imported.table, log.table)
    with pytest.raises(rg.InputError, match="--out"):
        log.write(tmp_path / "log.parquet")


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: rg.simulate(case="in-the-dark"), "--case.*did you mean|--case"),
        (lambda: rg.simulate(effects=("motor_lagg:x=1",)), "did you mean motor_lag"),
        (lambda: rg.simulate(engine="bullet"), "--engine: got 'bullet'"),
        (lambda: rg.gain([], "epuck", engine="bullet"), "--engine: got 'bullet'"),
        (lambda: rg.measure_health(runs=1, engine="bullet", out="x.json"), "--engine"),
        (lambda: rg.blind("x", engine="bullet"), "--engine: got 'bullet'"),
        (lambda: rg.demo("x", engine="bullet"), "--engine: got 'bullet'"),
        (lambda: rg.study.readings("x", engine="bullet"), "--engine: got 'bullet'"),
        (lambda: rg.study.transfer("x", engine="bullet"), "--engine: got 'bullet'"),
        (lambda: rg.read_log(3), "log: got 3"),
        (lambda: rg.read_log([]), "log: got nothing"),
        (lambda: rg.read_log("nowhere.csv"), "nowhere.csv"),
        (lambda: rg.read_log("x", format="papyrus"), "FORMAT: got papyrus"),
        (lambda: rg.read_log("x.csv", map="m.toml"), "map"),
        (lambda: rg.read_log(pd.DataFrame({"t": [0.0]}), format="csv", map="m"), "SOURCE"),
        (lambda: rg.replay("x.csv", horizon=-1.0), "horizon: got -1"),
        (lambda: rg.diagnose("x.csv", without=("magic",)), "--without"),
        (lambda: rg.Model.load("epuk"), "did you mean epuck"),
        (lambda: rg.study.paper("x", runs=0), "--runs"),
        (lambda: rg.measure_health(out="x.json"), "LOG"),
    ],
)
def test_bad_input_is_one_clear_error(call: object, said: str) -> None:
    assert callable(call)
    with pytest.raises(rg.InputError, match=said):
        call()

"""The transfer study: paired runs, models made blindly, differences with intervals."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.belief.modelfile import find_model_file, load_model, load_models
from realitygap.reality.effects import parse_effects
from realitygap.studies.hidden.shares import oracle, write_oracle
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.run.experiment import RunConfig
from realitygap.studies.transfer.alterations import SHIPPED, chosen
from realitygap.studies.transfer.beliefs import Preparation, record_and_diagnose
from realitygap.studies.transfer.compare import compare
from realitygap.studies.transfer.measures import choices
from realitygap.studies.transfer.plan import (
    MODELS,
    TransferConfig,
    log_config,
    plan,
    transfer_config,
)
from realitygap.studies.transfer.study import run_transfer
from realitygap.studies.transfer.words import reason
from tests.browser import CHROMIUM, check_fits
from tests.helpers import page_text, realitygap

WINDOW = "second_lamp:x=0.6,y=0,intensity=2"


def test_every_model_meets_the_same_seeds_and_the_same_alteration() -> None:
    runs = plan(transfer_config(alterations=tuple(SHIPPED.values()), runs=3, bars=2))
    for one in SHIPPED.values():
        own = [run for run in runs if run.alteration == one]
        seeds = {
            model: [r.config.seed for r in own if r.controller == model]
            for model in (*MODELS, "search")
        }
        assert seeds["minimal"] == seeds["extended"] == seeds["oracle"]
        assert seeds["search"] == seeds["minimal"][:2]
        assert len(set(seeds["minimal"])) == 3
        assert all(run.effects == one.effects and run.config.case == one.case for run in own)
    assert len({run.config.seed for run in runs}) == 3 * len(SHIPPED)
    assert len({run.name for run in runs}) == len(runs)


def test_a_study_stopped_early_has_whole_pairs() -> None:
    runs = plan(transfer_config(alterations=(SHIPPED["latency"], SHIPPED["half-blind"]), runs=4))
    first = [(run.alteration.name, run.index, run.controller) for run in runs[:8]]
    pairs = [(name, index) for name, index, _ in first]
    assert pairs[0::2] == pairs[1::2]
    assert [controller for *_, controller in first] == ["minimal", "extended"] * 4


def test_the_diagnosed_log_has_a_seed_of_its_own() -> None:
    study = transfer_config(alterations=tuple(SHIPPED.values()), runs=20)
    logs = {log_config(study, one).seed for one in study.alterations}
    assert not logs & {run.config.seed for run in plan(study)}


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_every_shipped_alteration_can_be_hidden_and_believed(name: str) -> None:
    hidden = parse_effects(SHIPPED[name].effects, 10)
    believed = oracle(hidden)
    assert [cause.name for cause in believed.causes] == [one.effect.name for one in hidden]


def test_the_oracle_believes_what_is_hidden(tmp_path: Path) -> None:
    specs = (WINDOW, "motor_saturation:limit=3.6,wheel=left,robot=1", "ls_dead_sensor:sensor=4")
    write_oracle(parse_effects(specs, 3), tmp_path)
    minimal, models = load_model(), load_models(tmp_path / "extended.toml", 3)
    assert [m.drive.speed_limit[0] for m in models] == [np.inf, 3.6, np.inf]
    assert all(m.drive.speed_limit[1] == np.inf for m in models)
    assert all(m.senses.second_lamp == (0.6, 0.0, 2.0) for m in models)
    assert all(m.senses.ls_gain[4] == 0.0 and m.senses.ls_gain[3] == 1.0 for m in models)
    assert replace(models[0], senses=minimal.senses).drive == minimal.drive


LISTS_AND_ANSWERS = """
import json, os, pathlib, sys
import pandas as pd
there = sorted(os.listdir("."))
runs = sorted(set(pd.read_parquet("samples.parquet")["run"]))
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir()
(out / "diagnosis.json").write_text(json.dumps({"there": there, "runs": runs}))
(out / "extended.toml").write_text("")
"""


def test_the_extended_model_is_made_by_a_process_that_has_the_log_alone() -> None:
    config = RunConfig(minutes=0.05, robots=2, seed=1)
    task = Preparation(SHIPPED["latency"], config, (sys.executable, "-c", LISTS_AND_ANSWERS))
    files = record_and_diagnose(task)
    assert sorted(files) == ["diagnosis.json", "extended.toml"]
    given = json.loads(files["diagnosis.json"])
    assert given == {"there": ["samples.parquet"], "runs": ["log"]}


def test_a_failed_diagnosis_is_an_error() -> None:
    config = RunConfig(minutes=0.05, robots=2, seed=1)
    task = Preparation(SHIPPED["latency"], config, (sys.executable, "-c", "raise SystemExit(3)"))
    with pytest.raises(RuntimeError, match="the diagnosis of latency: exit code 3"):
        record_and_diagnose(task)


def _table(gain: float, noise: float = 0.2) -> pd.DataFrame:
    """Twelve pairs: large differences between seeds, small ones within."""
    random = np.random.default_rng(7)
    base = random.uniform(2.0, 8.0, 12)
    values = {"minimal": base, "extended": base + gain + noise * np.tile([1, -1], 6)}
    return pd.concat(
        [
            pd.DataFrame(
                {"alteration": "a", "model": model, "index": range(12), "food": food}
                | dict.fromkeys(("fitness_real", "gap", "right_third", "minutes_to_adapt"), np.nan)
            )
            for model, food in values.items()
        ],
        ignore_index=True,
    )


@pytest.mark.parametrize(("gain", "verdict"), [(1.0, "more"), (-1.0, "less"), (0.0, "not shown")])
def test_pairs_show_differences_far_smaller_than_those_between_seeds(
    gain: float, verdict: str
) -> None:
    found = compare(_table(gain), seed=1)
    row = found[found["metric"] == "food"].iloc[0]
    assert (row["first"], row["second"], row["pairs"]) == ("extended", "minimal", 12)
    assert row["verdict"] == verdict
    assert row["low"] <= row["difference"] <= row["high"]
    assert row["difference"] == pytest.approx(gain)
    assert (row["p"] < 0.01) == (gain != 0.0)


def test_values_that_are_missing_are_no_pairs() -> None:
    row = compare(_table(1.0), seed=1).set_index("metric").loc["gap"]
    assert row["pairs"] == 0
    assert row["verdict"] == ""


def _earnings(best: tuple[int, int, int]) -> np.ndarray:
    table = np.ones((3, 9))
    for scenario, controller in enumerate(best):
        table[scenario, controller] = 50.0
    return table


def test_the_report_says_why_a_better_model_may_not_bring_more_food() -> None:
    same = _earnings((1, 4, 7))
    picks = choices({"minimal": same, "extended": same, "oracle": same}, 2)
    assert "the same of the nine controllers" in reason(picks)
    other = _earnings((1, 4, 3))
    picks = choices({"minimal": same, "extended": other, "oracle": other}, 2)
    assert "minimal model picks towards / search (1 s in the altered world)" in reason(picks)
    assert "wrong S0" not in reason(picks)
    lucky = _earnings((3, 4, 7))
    picks = choices({"minimal": lucky, "extended": other, "oracle": other}, 2)
    assert "finds as good a one by a wrong S0 (opposite)" in reason(picks)


def _tiny(given: Path) -> TransferConfig:
    return transfer_config(
        alterations=chosen((WINDOW,), "light-opposite-nest", 2),
        runs=3,
        bars=1,
        minutes=1.2,
        robots=2,
        seed=9,
        trials=2,
        genome="continuous",
        extended=str(given / "extended.toml"),
    )


def test_a_tiny_study_runs_resumes_and_reports(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    given = tmp_path / "given"
    given.mkdir()
    write_oracle(parse_effects((WINDOW,), 2), given)
    study = _tiny(given)
    out = tmp_path / "study"
    said = run_transfer(study, out, Workers(1), quiet=True)
    assert said.startswith("Of 1 altered realities the extended model brings more food")
    report = (out / "transfer.json").read_bytes()
    content = json.loads(report)
    (entry,) = content["alterations"]
    assert entry["diagnosed"] == "a given model"
    assert {row["metric"] for row in entry["comparisons"]} >= {"food", "gap", "fitness_real"}
    page = page_text(out / "report.html")
    assert said in page
    assert "data:image/png;base64," in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    if CHROMIUM is not None:
        check_fits(out / "report.html", tmp_path)
    runs = pd.read_csv(out / "runs.csv")
    by = runs.set_index(["model", "index"])["food"]
    assert by["extended"].tolist() == by["oracle"].tolist()  # the given model is the true one
    run_transfer(study, out, Workers(1), quiet=True)  # nothing is left to do
    assert (out / "transfer.json").read_bytes() == report
    model = out / "models" / "given.extended" / "extended.toml"
    model.write_bytes(model.read_bytes()[:100])
    runs = out / "runs"
    shutil.copy(runs / "given.oracle-00" / "generations.parquet", runs / "given.search-00")
    run_transfer(study, out, Workers(1), quiet=False)
    said = [line for line in capfd.readouterr().err.splitlines() if "made anew" in line]
    assert said == [
        "model given.extended is made anew: its extended.toml is not as it was written",
        "run given.search-00 is made anew: its generations.parquet is not as it was written",
    ]
    assert (out / "transfer.json").read_bytes() == report
    (given / "extended.toml").write_text(f"{(given / 'extended.toml').read_text()}# another\n")
    with pytest.raises(InputError, match="extended_hash"):
        run_transfer(_tiny(given), out, Workers(1), quiet=True)


def test_a_given_model_that_cannot_be_used_is_refused_before_anything_is_written(
    tmp_path: Path,
) -> None:
    wrong = tmp_path / "extended.toml"
    wrong.write_text("wheels = 3\n" + find_model_file("epuck").read_text())
    for extended, said in ((wrong, "wheels"), (tmp_path / "nowhere.toml", "a model file")):
        with pytest.raises(InputError, match=said):
            transfer_config(alterations=(SHIPPED["latency"],), extended=str(extended))


def test_words_that_cannot_be_used_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean half-blind"):
        chosen(("half-blnd",), "no-light", 10)
    done = realitygap("study", "transfer", "--runs", "0", "--out", tmp_path / "x")
    assert done.returncode == 2
    assert done.stderr.startswith("realitygap: --runs")
    assert not (tmp_path / "x").exists()

"""Results as objects: they show themselves, draw themselves, and travel to another process."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pandas as pd
import pytest
from matplotlib.axes import Axes

import realitygap as rg
from realitygap.models.log.named import Names
from realitygap.studies.pages.notebook import Telling
from tests.helpers import ROOT
from tests.models.small import driven_log

ROBOT = "wheel_radius = 0.0205\naxle = 0.053\nbody_radius = 0.035\nwheel_speed_max = 6.28\n"
LOGS = ROOT / "tests" / "golden" / "logs"


@pytest.fixture(autouse=True)
def _closed(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    mpl.use("Agg")
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> rg.StudyResult:
    """As a finished one leaves its table."""
    room = tmp_path_factory.mktemp("study")
    rows = [("search", "default", 3), ("search", "literal", 5), ("coevolution", "default", 9)]
    table = pd.DataFrame(rows, columns=["condition", "variant", "food_total"])
    table.to_parquet(room / "study.parquet")
    return rg.StudyResult(room, "one claim reproduced")


@cache
def result(name: str) -> object:
    log = rg.read_log(LOGS / "single-wheel_radius_mismatch.parquet")
    if name == "log":
        return log
    if name == "gap":
        return rg.measure_gap(log)
    if name == "diagnosis":
        return rg.diagnose(log)
    if name == "model":
        found = result("diagnosis")
        assert isinstance(found, rg.DiagnosisResult)
        return found.extended
    if name == "gain":
        model = result("model")
        assert isinstance(model, rg.Model)
        return rg.gain(LOGS / "swarm-wheel_radius_mismatch.parquet", model, jobs=1)
    return rg.simulate(minutes=1.1, robots=2, controller="search")


NAMES = ("diagnosis", "gap", "gain", "run", "log", "model")
DRAWN = NAMES[:-1]


@pytest.mark.parametrize("name", NAMES)
def test_a_result_shows_itself_as_html_with_a_table(name: str) -> None:
    shown = result(name)._repr_html_()  # type: ignore[attr-defined]
    assert shown.startswith("<div>")
    assert shown.count("<div>") == shown.count("</div>") == 1
    assert "<table" in shown


@pytest.mark.parametrize("name", DRAWN)
def test_a_result_draws_itself_into_given_axes_or_new_ones(name: str) -> None:
    drawn = result(name)
    fresh = drawn.plot()  # type: ignore[attr-defined]
    assert isinstance(fresh, Axes)
    assert fresh.has_data()
    assert fresh.get_xlabel()
    given = plt.subplots()[1]
    assert drawn.plot(given) is given  # type: ignore[attr-defined]
    assert given.has_data()


@pytest.mark.parametrize("name", NAMES)
def test_a_result_survives_pickling(name: str) -> None:
    again = pickle.loads(pickle.dumps(result(name)))
    assert type(again) is type(result(name))
    assert repr(again) == repr(result(name))
    assert again._repr_html_() == result(name)._repr_html_()  # type: ignore[attr-defined]


def test_a_pickled_diagnosis_writes_the_same_files(tmp_path: Path) -> None:
    found = result("diagnosis")
    assert isinstance(found, rg.DiagnosisResult)
    found.write(tmp_path / "one")
    pickle.loads(pickle.dumps(found)).write(tmp_path / "two")
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes(), path.name


def test_a_drawn_diagnosis_shows_measured_predicted_and_corrected() -> None:
    found = result("diagnosis")
    assert isinstance(found, rg.DiagnosisResult)
    labels = found.plot().get_legend_handles_labels()[1]
    assert labels == ["measured", "predicted", "corrected"]


def test_drawing_leaves_the_users_settings_alone(tmp_path: Path) -> None:
    before = dict(mpl.rcParams)
    found = result("diagnosis")
    assert isinstance(found, rg.DiagnosisResult)
    found.write(tmp_path / "found")
    assert dict(mpl.rcParams) == before


def test_a_study_tells_of_food_by_what_was_run(study: rg.StudyResult) -> None:
    assert list(study.food["what"]) == ["search", "search, literal", "coevolution"]
    assert list(study.table_told()["mean"]) == [3.0, 5.0, 9.0]
    assert "items in a run" in study.plot().get_xlabel()
    assert "one claim reproduced" in study._repr_html_()
    again = pickle.loads(pickle.dumps(study))
    assert again.food.equals(study.food)


def test_a_study_of_transfer_has_food_per_minute(tmp_path: Path) -> None:
    rows = [("dim", "minimal", 2.0), ("dim", "extended", 3.5)]
    table = pd.DataFrame(rows, columns=["alteration", "model", "food"])
    table.to_csv(tmp_path / "runs.csv", index=False)
    study = rg.StudyResult(tmp_path, "")
    assert list(study.food["what"]) == ["dim, minimal", "dim, extended"]
    assert study.plot().get_xlabel() == "food (items per minute)"


def test_every_result_of_the_door_is_tested_here() -> None:
    results = {name for name in rg.__all__ if name.endswith("Result")}
    for name in rg.__all__:
        getattr(rg, name)  # what stands behind the door is imported when it is asked for
    tellers = {cls.__name__ for cls in Telling.__subclasses__()}
    assert results == {"DiagnosisResult", "GapResult", "GainResult", "RunResult", "StudyResult"}
    assert tellers == results | {"ProposedExperiment"}  # tested where it is made


def test_hostile_names_stay_text_in_a_notebook(tmp_path: Path) -> None:
    bad = "<script>alert(1)</script>"
    (tmp_path / "open.toml").write_text(f'name = "{bad}"\n[robot]\n{ROBOT}')
    frame = driven_log(1, robots=1, rows=200).assign(robot=bad)
    log = rg.read_log(frame, model=tmp_path / "open.toml")
    found = result("diagnosis")
    assert isinstance(found, rg.DiagnosisResult)
    names = Names(dict.fromkeys(found.examined.diagnosis.robots, bad))
    changed = replace(found.examined.diagnosis, names=names)
    hostile = replace(found, examined=replace(found.examined, diagnosis=changed))
    for shown in (log._repr_html_(), log.model._repr_html_(), hostile._repr_html_()):
        assert "<script" not in shown
        assert "&lt;script&gt;" in shown

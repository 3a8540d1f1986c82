"""What a finished study is made into: the tables, the figures, and one page that needs nothing."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pandas as pd
import pytest

from realitygap.studies.paper.conditions import STUDIED, plan
from realitygap.studies.paper.study import run_study
from realitygap.studies.plumbing.execution import Workers
from tests.helpers import page_text
from tests.studies.small_study import TINY, results

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
SMALL = TINY.model_copy(update={"runs": 2, "minutes": 1.2, "robots": 3})
FIGURES = ("fig6-food", "fig7-retrieval", "fig8-s0", "gap-course", "gap-parts")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs per condition, long enough for one whole generation and some deposits."""
    out = tmp_path_factory.mktemp("report") / "study"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("realitygap.studies.fitness_gap.generations.TRIALS", 20)
        run_study(SMALL, out, Workers(2), quiet=True)
    return out


def test_a_study_leaves_its_tables_figures_and_page(study: Path) -> None:
    files = {str(path.relative_to(study)) for path in study.rglob("*") if path.is_file()}
    expected = {"study.json", "study.parquet", "generations.parquet", "report.html"}
    expected |= {"claims.csv", "results.md", "evolved.csv"}
    expected |= {"gap.csv", "controllers.csv"}
    expected |= {f"figures/{name}.{kind}" for name in FIGURES for kind in ("png", "svg")}
    assert expected <= files


def test_the_study_table_has_a_row_per_run_with_its_seed(study: Path) -> None:
    table = pd.read_parquet(study / "study.parquet")
    runs = plan(SMALL, STUDIED)
    assert table["seed"].tolist() == [run.config.seed for run in runs]
    assert (table["food_first"] + table["food_second"] == table["food_total"]).all()
    quarters = table[[f"food_q{i}" for i in range(1, 5)]].sum(axis=1)
    assert (quarters == table["food_total"]).all()


def test_all_generations_are_those_of_the_runs(study: Path) -> None:
    together = pd.read_parquet(study / "generations.parquet")
    alone = [pd.read_parquet(path) for path in study.glob("runs/*/generations.parquet")]
    assert len(together) == sum(len(table) for table in alone)
    assert set(together["run"]) == {run for table in alone for run in table["run"]}


def test_the_parts_of_the_gap_add_up_to_it(study: Path) -> None:
    gap = pd.read_csv(study / "gap.csv")
    assert (gap["curse"] + gap["scenario"] + gap["model"] - gap["gap"]).abs().max() < 1e-3
    assert (gap["fitness_sim"] - gap["fitness_real"] - gap["gap"]).abs().max() < 1e-3


def test_making_the_report_again_changes_no_byte_of_the_results(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = results(study)
    monkeypatch.setattr("realitygap.studies.fitness_gap.generations.TRIALS", 20)
    said = run_study(SMALL, study, Workers(1), quiet=True)
    assert results(study) == before
    assert said in page_text(study / "report.html")
    assert said in " ".join((study / "results.md").read_text(encoding="utf-8").split())


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_the_page_opens_without_console_errors_or_network_requests(
    study: Path, tmp_path: Path
) -> None:
    page, console, asked = _open(study / "report.html", tmp_path)
    assert "Claims of section IV" in page
    assert page.count("data:image/png;base64,") == len(FIGURES)
    assert console == []
    assert asked == []


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_a_page_with_faults_would_be_noticed(tmp_path: Path) -> None:
    bad = tmp_path / "bad.html"
    bad.write_text('<img src="http://example.com/a.png"><script>missing()</script>')
    _, console, asked = _open(bad, tmp_path)
    assert any("missing is not defined" in line for line in console)
    assert "http://example.com/a.png" in asked


def _open(page: Path, scratch: Path) -> tuple[str, list[str], list[str]]:
    """The rendered page, its console lines, and what it asked the network for."""
    assert CHROMIUM is not None
    log = scratch / "net.json"
    done = subprocess.run(
        [
            *(CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"),
            *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
            *("--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr"),
            *(f"--user-data-dir={scratch / 'profile'}", f"--log-net-log={log}"),
            *("--virtual-time-budget=3000", "--dump-dom", page.as_uri()),
        ],
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    events = [event.get("params", {}) for event in json.loads(log.read_text())["events"]]
    asked = [
        event["url"]
        for event in events
        if event.get("initiator", "not an origin") != "not an origin"  # the browser's own requests
        and not event["url"].startswith(("file:", "data:"))
    ]
    console = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
    return done.stdout, console, asked

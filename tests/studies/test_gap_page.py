"""The page of a gap: it says what gap.json says, in the style of every page."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pandas as pd
import pytest

import realitygap as rg
from realitygap.studies.gap.page import OFF
from realitygap.studies.pages.page import PageTable
from tests.browser import CHROMIUM, WIDTHS, browser
from tests.helpers import ROOT, page_text

LOGS = {True: "single-wheel_radius_mismatch", False: "healthy-search-no-light"}


@pytest.fixture(scope="module")
def gaps(tmp_path_factory: pytest.TempPathFactory) -> dict[bool, Path]:
    """Of a log with an odd robot, and of one without."""
    room = tmp_path_factory.mktemp("gaps")
    for name in LOGS.values():
        rg.measure_gap(ROOT / "tests" / "golden" / "logs" / f"{name}.parquet", out=room / name)
    return {odd: room / name for odd, name in LOGS.items()}


def test_the_heading_of_a_column_of_numbers_stands_above_them() -> None:
    table = PageTable.of(pd.DataFrame({"who": ["a", "b"], "size": [float("nan"), 1.0]}))
    assert [head.kind for head in table.heads] == ["", "number"]


@pytest.mark.parametrize("odd", LOGS)
def test_the_page_of_a_gap_says_what_its_json_says(gaps: dict[bool, Path], odd: bool) -> None:
    content = json.loads((gaps[odd] / "gap.json").read_text(encoding="utf-8"))
    page = (gaps[odd] / "report.html").read_text(encoding="utf-8")
    assert (OFF in page) == content["flagged"]
    assert ('class="box fault"' in page) == content["flagged"]
    assert ("No channel departs" in page) == (not content["flagged"])
    figures = {path.stem for path in gaps[odd].glob("*.png")}
    assert {"horizons", "shares", "maps", "arena"} <= figures
    assert page.count("data:image/png") == len(figures)
    for one in content["horizons"]:
        assert f"{1000 * one['position']['median']:.3g} mm" in page
    assert page.count("<td>robot ") == len(content["robots"])


def test_a_robot_unlike_the_others_is_called_by_its_name(gaps: dict[bool, Path]) -> None:
    page = (gaps[True] / "report.html").read_text(encoding="utf-8")
    content = json.loads((gaps[True] / "gap.json").read_text(encoding="utf-8"))
    odd = [one["robot"] for one in content["robots"] if one["flagged"]]
    assert odd
    for robot in odd:
        assert f"{robot.capitalize()} is unlike the others" in page


@pytest.mark.parametrize("odd", LOGS)
def test_every_range_in_a_gaps_words_has_its_unit(gaps: dict[bool, Path], odd: bool) -> None:
    content = json.loads((gaps[odd] / "gap.json").read_text(encoding="utf-8"))
    told = re.findall(r"[-\d.e]+ to [-\d.e]+(.{0,6})", " ".join(content["summary"]))
    assert told or not odd
    assert all(re.match(r" (m|s|m/s|rad/s|rad)\b", after) for after in told), told


def test_generations_alone_have_a_page(tmp_path: Path) -> None:
    run = rg.simulate(minutes=2.2, robots=3, samples=False, out=tmp_path / "run")
    assert isinstance(run.generations, pd.DataFrame)
    found = rg.measure_gap(tmp_path / "run", out=tmp_path / "gap")
    page = page_text(tmp_path / "gap" / "report.html")
    assert found.summary[0] in page
    assert "Fitness in simulation and reality" in page
    assert OFF not in page


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_the_page_of_a_gap_fits_phone_and_desk_by_day_and_night(
    gaps: dict[bool, Path], tmp_path: Path
) -> None:
    with browser(tmp_path) as page:
        for width in WIDTHS:
            for dark in (False, True):
                look = page.open(gaps[True] / "report.html", width, dark=dark)
                assert (look["wide"], look["overlaps"], look["broken"]) == (0, 0, 0)
        assert page.console == []
        assert [one for one in page.asked if not one.startswith(("file:", "data:"))] == []


def test_there_is_one_template_and_one_style() -> None:
    holders = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "studies").rglob("*")
        if path.suffix in (".py", ".j2", ".css", ".html")
        and ("<html" in (text := path.read_text(encoding="utf-8")) or "@media" in text)
    ]
    plays = "studies/replay/replay.html.j2"  # the one page that moves, whole by itself
    pages = ["studies/pages/report.html.j2", "studies/pages/style.css"]
    assert sorted(holders) == [*pages, plays]

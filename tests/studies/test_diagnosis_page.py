"""The page of a diagnosis: what it says to whoever must repair a robot, and how it looks."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import realitygap as rg
from realitygap.models.belief.catalogue import causes, every_cause
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.log.named import Names
from realitygap.models.naming.diagnosis import Calibrated, Diagnosis, Unexplained
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Evidence, Named
from realitygap.studies.diagnosis.box import model_lines, plain_sentence, verdict_box
from realitygap.studies.diagnosis.figures import rival_bars
from realitygap.studies.diagnosis.tables import calibration_section
from realitygap.studies.diagnosis.tracks import worst_tracks
from realitygap.studies.pages.page import Words, meanings
from tests.browser import CHROMIUM, WIDTHS, browser
from tests.helpers import ROOT, page_text

LOGS = {
    "named": "single-wheel_radius_mismatch",
    "ambiguous": "single-ambient_light",
    "unexplained": "unlisted-carpet",
    "nothing_wrong": "healthy-search-no-light",
}
LEFT = Unexplained(channel="speed", share=0.2, where="it drifts", robots=(1,), quantity="error")
LAG = Term(causes()["motor_lag"], "")


def value(parameter: Parameter, side: float) -> Value:
    """A value somewhat above or below the null; where there is none on that side, on the other."""
    relative = parameter.null == 1.0
    for sign in (side, -side):
        sizes = (0.02 * sign, 0.018 * sign, 0.022 * sign)
        middle, one, other = (1.0 + s if relative else parameter.zero + s for s in sizes)
        if parameter.low <= min(one, other) and max(one, other) <= parameter.high:
            break
    return Value(parameter.name, middle, min(one, other), max(one, other), parameter.unit)


def named(
    cause: Cause,
    side: float = 1.0,
    *,
    variant: str | None = None,
    robots: tuple[int, ...] = (3,),
    exported: bool = True,
    rivals: tuple[Term, ...] = (),
) -> Named:
    term = Term(cause, cause.variants[0] if variant is None else variant)
    evidence = Evidence(
        term=term,
        coordinates=np.zeros(len(cause.parameters)),
        covariance=np.eye(len(cause.parameters)),
        gain=500.0,
        share=0.4,
        distance=9.0,
        rivals=rivals,
    )
    return Named(
        term=term,
        robots=robots,
        whole_swarm=cause.place,
        values=tuple(value(p, side) for p in cause.parameters),
        given=tuple(Value(p.name, 170.0, 170.0, 170.0, p.unit) for p in cause.given),
        evidence=evidence,
        twins=(),
        exported=exported,
        why="" if exported else "seen, but worse: not exported",
    )


@pytest.mark.parametrize("name", every_cause())
def test_every_cause_has_a_plain_sentence_for_each_of_its_words_and_sides(name: str) -> None:
    cause = every_cause()[name]
    for variant in cause.variants:
        for side in (1.0, -1.0):
            said = plain_sentence(named(cause, side, variant=variant), Names())
            assert said
            assert not re.search(r"[{}]|nan|\bNone\b", said)
            assert said[0].isupper()
            assert said.endswith(".")
            if cause.parameters:
                assert re.search(r"\d ?(%|mm|ms|°|counts|rad/s|m)?.* \(", said)
            for sentence in re.split(r"\. ", re.sub(r" \([^)]*\)", "", said)):
                assert len(sentence.split()) <= 25


def test_a_larger_wheel_is_told_as_one_says_it() -> None:
    cause = every_cause()["wheel_radius_mismatch"]
    one = plain_sentence(named(cause), Names())
    assert one.startswith("Robot 3's right wheel is 2.0 % (1.8 to 2.2 %) larger than its left.")
    other = plain_sentence(named(cause, -1.0), Names({3: "alice"}))
    assert other.startswith("Robot alice's right wheel is 2.0 % (1.8 to 2.2 %) smaller than")
    both = plain_sentence(named(cause, robots=(3, 5)), Names())
    assert both.startswith("Robot 3's and robot 5's right wheel is")
    all_of_them = plain_sentence(replace(named(cause), whole_swarm=True), Names())
    assert all_of_them.startswith("Every robot's right wheel is")


def test_small_values_are_told_in_units_that_people_use() -> None:
    late = plain_sentence(named(every_cause()["clock_offset"], -1.0), Names())
    assert "stamped 20 ms (18 to 22 ms) early" in late
    turned = plain_sentence(named(every_cause()["tracker_yaw_offset"]), Names())
    assert "1.1° (1.0 to 1.3°) counter-clockwise" in turned
    droop = every_cause()["speed_droop"]
    slow = replace(named(droop), values=(Value("rate", 1e-4, 9e-5, 1.1e-4, "1/s"),))
    assert "lose 0.60 % per minute (0.54 to 0.66 % per minute)" in plain_sentence(slow, Names())


def test_the_lines_for_the_model_are_those_of_its_file() -> None:
    saturated = replace(
        named(causes()["motor_saturation"], variant="left"),
        values=(Value("limit", 4.5, 4.4, 4.6, "rad/s"),),
    )
    dead = named(every_cause()["ir_dead_sensor"], variant="2")
    found = Diagnosis(named=(saturated, dead, named(causes()["motor_lag"], exported=False)))
    read = Extension(**tomllib.loads(model_lines(found))["extension"])
    assert [one.name for one in read.causes] == ["motor_saturation", "ir_dead_sensor"]
    assert read.causes[0].word == "left"
    assert read.causes[0].robots == (3,)
    assert read.causes[0].parameters["limit"].value == 4.5
    assert model_lines(Diagnosis(named=())) == ""


@given(
    st.lists(
        st.tuples(st.sampled_from(sorted(every_cause())), st.booleans(), st.booleans()),
        max_size=3,
        unique_by=lambda one: one[0],
    ),
    st.booleans(),
    st.booleans(),
)
def test_the_box_never_says_two_things(
    wrong: list[tuple[str, bool, bool]], left: bool, reference: bool
) -> None:
    """Something is wrong or nothing is; what is sure is not also unsure."""
    found = Diagnosis(
        named=tuple(
            named(every_cause()[name], exported=exported, rivals=(LAG,) if rival else ())
            for name, exported, rival in wrong
        ),
        unexplained=(LEFT,) if left else (),
        robots=(1, 3),
        reference="e-puck" if reference else "",
    )
    box = verdict_box(found)
    said = " ".join([box.headline, *box.texts])
    assert ("Nothing wrong" in said) == (not wrong and not left)
    assert (box.tone == "sound") == (not wrong and not left and reference)
    assert ("no known cause explains" in said) == left
    assert bool(box.code) == any(one.exported for one in found.named)
    for one in found.named:
        told = plain_sentence(one, Names())
        assert said.count(told) == 1
        unsure = not one.exported or (one.evidence.rivals and one.term.cause is not LAG.cause)
        assert bool(re.search(rf"(Either|It may be this): {re.escape(told)}", said)) == bool(unsure)
        missing = rf"\b{one.term.cause.name} is not in extended.toml"  # no slip in a side_slip
        assert bool(re.search(missing, said)) == (not one.exported)


def test_a_calibration_is_told_with_its_values_and_errors() -> None:
    """Values without a name of their own: which, of which wheel, and what they take off."""
    terms = (
        NamedCause(
            name="motor_saturation",
            word="right",
            parameters={"limit": ParameterValue(value=5.2)},
        ),
        NamedCause(
            name="motor_lag",
            parameters={"time_constant": ParameterValue(value=0.25)},
        ),
    )
    one = Calibrated(robot=1, terms=terms, errors={"position_5s": (0.042, 0.029)})
    (section,) = calibration_section((one,), Names())
    (table,) = section.tables
    (row,) = table.rows
    told = {
        name: getattr(cell, "text", cell) for name, cell in zip(table.columns, row, strict=True)
    }
    assert told["robot"] == "1"
    assert "limit 5.2 rad/s (right); " in told["values"]
    assert "0.25 s" in told["values"]
    assert told["position 5s"] == "0.042 to 0.029 m"
    assert not calibration_section((), Names())


def test_the_named_cause_has_the_first_bar_of_its_chart() -> None:
    one = named(causes()["motor_saturation"], variant="left")
    tried = (("motor_lag", 600.0), (one.term.key, 500.0), ("speed_droop", 100.0))
    shown = rival_bars(replace(one, evidence=replace(one.evidence, gains=tried)))
    assert next(iter(shown.items())) == (one.term.key, 500.0)
    assert list(shown)[1:] == ["motor_lag", "speed_droop"]
    swapped = rival_bars(replace(one, twins=(LAG,)))
    assert swapped == {one.term.key: 500.0, LAG.key: 500.0}


def test_a_word_of_the_glossary_is_explained_the_first_time_and_the_text_stays_text() -> None:
    words = Words()
    said = str(words("A <b>null</b> & the Null's twin causes"))
    assert said.count("<abbr") == 3
    assert f'title="{meanings()["twin"]}"'.replace("'", "&#39;") in said
    assert "&lt;b&gt;" in said
    assert "<b>" not in said
    assert set(words.said) == {"null", "twin", "cause"}
    assert "<abbr" not in str(words("null"))


def test_the_installed_glossary_is_that_of_the_documents() -> None:
    copy, home = ROOT / "studies/pages/glossary.md", ROOT / "docs/glossary.md"
    assert copy.read_bytes() == home.read_bytes(), f"copy {home} to {copy}"


@cache
def diagnosed(verdict: str) -> rg.DiagnosisResult:
    return rg.diagnose(ROOT / "tests" / "golden" / "logs" / f"{LOGS[verdict]}.parquet")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """By verdict, a page."""
    room = tmp_path_factory.mktemp("pages")
    found = {}
    for verdict in LOGS:
        diagnosed(verdict).write(room / verdict)
        found[verdict] = room / verdict / "report.html"
    return found


def rows(page: str, title: str) -> list[list[str]]:
    """Cells of the first table under a heading."""
    table = page[page.index(f"<h2>{title}</h2>") :].partition("</table>")[0]
    return [
        [re.sub(r"<[^>]*>", "", cell) for cell in re.findall(r"<td[^>]*>(.*?)</td>", row)]
        for row in re.findall(r"<tr>(.*?)</tr>", table, flags=re.DOTALL)[1:]
    ]


def test_a_page_begins_with_the_verdict_and_ends_with_what_was_not_checked(
    pages: dict[str, Path],
) -> None:
    page = pages["named"].read_text(encoding="utf-8")
    said = "Robot 1&#39;s right wheel is 4.1 % (3.8 to 4.3 %) larger than its left. Measure both."
    assert said in page
    order = ['<div class="box fault">', said, "[[extension.causes]]", "Where the robot went"]
    order += ["The evidence", "What the extended model gains", "Robot by robot"]
    order += ["What was not checked, and why", "<details>", "Words on this page"]
    at = [page.index(part) for part in order]
    assert at == sorted(at)
    assert '<abbr title="' in page


@pytest.mark.parametrize("verdict", LOGS)
def test_no_robot_is_sound_of_which_something_is_said(pages: dict[str, Path], verdict: str) -> None:
    found = diagnosed(verdict).examined.diagnosis
    assert found.verdict == verdict
    page = pages[verdict].read_text(encoding="utf-8")
    wrong = {robot for one in found.named for robot in one.robots}
    for one in found.unexplained:
        wrong |= set(found.robots) if one.robots == "all" else set(one.robots)
    table = rows(page, "Robot by robot")
    assert len(table) == len(found.robots)
    for robot, said, *_ in table:
        assert (said == "nothing wrong") == (int(robot) not in wrong)
    assert ("Nothing wrong" in page) == (verdict == "nothing_wrong")
    assert bool(wrong) == (verdict != "nothing_wrong")


@pytest.mark.parametrize("verdict", LOGS)
def test_no_cause_is_both_tried_and_not_checked(pages: dict[str, Path], verdict: str) -> None:
    page = page_text(pages[verdict])
    tried = set(re.findall(r"Tried: ([^.]*)\.", page)[0].split(", "))
    assert "wheel_radius_mismatch" in tried
    absent = re.findall(r"<li>no (?:ps0\.\.ps7|ls0\.\.ls7|nest|sensors): ([a-z_, ]+)</li>", page)
    unchecked = {name for listed in absent for name in listed.split(", ")}
    assert unchecked
    assert not tried & unchecked
    assert tried | unchecked <= set(every_cause())
    assert ("second_lamp" in tried) == (verdict == "ambiguous")


def test_a_cause_that_was_withheld_was_not_tried(tmp_path: Path) -> None:
    log = ROOT / "tests" / "golden" / "logs" / f"{LOGS['nothing_wrong']}.parquet"
    rg.diagnose(log, without=("motor_lag",), out=tmp_path / "page")
    (tried,) = re.findall(r"Tried: ([^.]*)\.", page_text(tmp_path / "page" / "report.html"))
    assert "motor_saturation" in tried
    assert "motor_lag" not in tried


def test_the_evidence_for_a_cause_in_the_light_is_counts_of_light(pages: dict[str, Path]) -> None:
    light = pages["ambiguous"].read_text(encoding="utf-8")
    assert "light sensor" in light
    assert "in counts" in light
    assert "predicted position is off" not in light
    motion = pages["named"].read_text(encoding="utf-8")
    assert "predicted position is off in mm" in motion
    assert "light sensor" not in motion


def test_two_robots_with_one_cause_have_each_its_own_evidence(tmp_path: Path) -> None:
    found = rg.diagnose(ROOT / "tests" / "golden" / "logs" / "single-ir_gain.parquet")
    diagnosis = found.examined.diagnosis
    one = next(one for one in diagnosis.named if one.term.cause.name == "ir_gain")
    other = next(robot for robot in diagnosis.robots if robot not in one.robots)
    both = replace(diagnosis, named=(one, replace(one, robots=(other,))))
    examined = replace(found.examined, diagnosis=both)
    replace(found, examined=examined).write(tmp_path / "page")
    page = (tmp_path / "page" / "report.html").read_text(encoding="utf-8")
    evidence = page[page.index("<h2>The evidence</h2>") : page.index("<h2>What the extended")]
    pictures = re.findall(r"base64,([^\"]+)", evidence)
    assert len(pictures) == 6  # two of readings and one of rivals for each
    assert len(set(pictures[:4])) == 4
    for robot in (*one.robots, other):
        assert f"Robot {robot}, infrared sensor" in evidence


def test_tracks_begin_at_the_measured_pose_and_the_corrected_one_stays_nearer() -> None:
    found = diagnosed("named")
    before, after = found.examined.model, found.extended.file
    seen = worst_tracks(found.log.measured, before, after, {1})
    assert seen is not None
    assert seen.robot == 1
    assert seen.off["corrected"] < 0.5 * seen.off["predicted"]
    for _, part in seen.table.groupby("stretch"):
        first = part.iloc[0]
        for name in ("predicted", "corrected"):
            assert first[f"{name}_x"] == first["measured_x"]
            assert first[f"{name}_y"] == first["measured_y"]
    worst = seen.table[seen.table["stretch"] == seen.worst].iloc[-1]
    off = math.hypot(
        worst["predicted_x"] - worst["measured_x"], worst["predicted_y"] - worst["measured_y"]
    )
    assert off == pytest.approx(seen.off["predicted"])


def test_a_hostile_name_stays_text(tmp_path: Path) -> None:
    bad = "<script>alert(1)</script>"
    found = diagnosed("named")
    names = Names(dict.fromkeys(found.examined.diagnosis.robots, bad))
    changed = replace(found.examined.diagnosis, names=names)
    replace(found, examined=replace(found.examined, diagnosis=changed)).write(tmp_path / "page")
    page = (tmp_path / "page" / "report.html").read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
@pytest.mark.parametrize("verdict", LOGS)
def test_a_page_fits_phone_and_desk_by_day_and_night_and_prints_on_two_sheets(
    pages: dict[str, Path], tmp_path: Path, verdict: str
) -> None:
    with browser(tmp_path) as page:
        for width in WIDTHS:
            day, night = (page.open(pages[verdict], width, dark=dark) for dark in (False, True))
            for look in (day, night):
                assert (look["wide"], look["overlaps"], look["broken"]) == (0, 0, 0)
            assert day["paper"] != night["paper"]
            assert day["ink"] != night["ink"]
        assert 1 <= page.sheets() <= 2
        assert page.console == []
        assert [one for one in page.asked if not one.startswith(("file:", "data:"))] == []

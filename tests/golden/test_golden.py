"""What is said of the kept logs is what was said when they were kept, to six digits."""

from __future__ import annotations

import json

import pytest

from realitygap.studies.hidden.menu import MENU
from tests.golden.answers import ANSWERS, LOGS, answer, answer_file, differences
from tests.golden.plan import plan

NAMES = tuple(plan())
FAST = (
    "healthy-search-no-light",
    "pair-wheel_radius_mismatch-ir_gain",
    "single-ir_offset",
    "unlisted-low_sun",
)
"""Of every kind one, that take a second of processor time or less."""


def test_every_kept_log_is_of_the_plan_and_has_its_answer() -> None:
    """`tests/studies/test_places.py` says what a listed effect still needs."""
    logs = {path.stem for path in LOGS.iterdir()}
    assert logs == {path.stem for path in ANSWERS.iterdir()}
    assert logs <= set(NAMES)
    listed = {n for n in NAMES if {hidden.name for hidden in plan()[n].trial.hidden} & set(MENU)}
    assert logs | listed == set(NAMES)
    assert set(FAST) < logs


@pytest.mark.parametrize(
    "name", [n if n in FAST else pytest.param(n, marks=pytest.mark.slow) for n in NAMES]
)
def test_what_is_said_of_a_kept_log_is_what_is_kept(name: str) -> None:
    now, kept = answer(name), answer_file(name).read_text(encoding="utf-8")
    if now != kept:
        pytest.fail("\n".join(map(str, differences(name, json.loads(kept), json.loads(now)))))


def test_a_difference_is_told_by_what_it_is_about() -> None:
    named = {
        "name": "motor_lag",
        "robots": [1],
        "exported": True,
        "parameters": {"time_constant": {"value": 0.1, "low": 0.09, "high": 0.11, "unit": "s"}},
    }
    before = {"verdict": "nothing_wrong", "causes": [], "unexplained": [], "notes": []}
    now = {"verdict": "named", "causes": [named], "unexplained": [], "notes": ["x"]}
    assert list(differences("log", before, before)) == []
    assert list(differences("log", before, now)) == [
        ("log", "verdict", "nothing_wrong", "named"),
        ("log", "motor_lag of 1", "-", "named"),
        ("log", "motor_lag of 1: time_constant", "-", "0.1 (0.09 to 0.11)"),
        ("log", "notes", "", "otherwise"),
    ]

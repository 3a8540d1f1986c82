"""The matrix of conditions: what is in it, how its answers count, and that it resumes."""

from __future__ import annotations

import json
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from typer.testing import CliRunner

from realitygap.embedded_sim import InputError
from realitygap.studies.blind.conditions import matrix
from realitygap.studies.blind.conditions.battery import run_matrix
from realitygap.studies.blind.conditions.matrix import (
    CONDITIONS,
    ILL,
    STATES,
    CellLog,
    matrix_config,
    plan,
)
from realitygap.studies.blind.conditions.page import MARK, TITLE, failures
from realitygap.studies.blind.conditions.page import matrix as as_told
from realitygap.studies.blind.conditions.scores import (
    LogResult,
    cells_of,
    log_result,
    logs_table,
    summary,
)
from realitygap.studies.cli import app
from realitygap.studies.plumbing.execution import Workers
from tests.blind.stub import ask_stub
from tests.browser import CHROMIUM, check_fits
from tests.helpers import ROOT

STUBBED = ("as-recorded", "row-of-2", "robots-2", "no-sensors")


def cells(trials: int = 1, **asked: Any) -> dict[str, CellLog]:
    return {cell.name: cell for cell in plan(matrix_config(trials=trials, **asked))}


def test_every_condition_meets_healthy_robots_and_each_kind_of_effect() -> None:
    found = cells()
    assert len(found) == 4 * len(CONDITIONS)
    assert {(c.condition, c.state) for c in found.values()} == {
        (name, state) for name in CONDITIONS for state in STATES
    }
    for cell in found.values():
        hidden = [one.name for one in cell.hidden]
        assert hidden == ([] if cell.state == "healthy" else [ILL[cell.state]])
        assert all(one.multiple == 1.0 for one in cell.hidden)


def test_logs_of_one_number_share_run_and_ill_robot_under_all_that_changes_logs_alone() -> None:
    found = [c for c in cells(seed=3).values() if not CONDITIONS[c.condition].run]
    assert len({c.run for c in found}) == 1
    for state in ILL:
        assert len({c.hidden[0].spec for c in found if c.state == state}) == 1
    order = [(c.index, c.state, c.run.model_dump_json()) for c in cells(trials=2).values()]
    assert order == sorted(order, key=order.index)
    switches = sum(one != other for one, other in pairwise(order))
    assert switches == len(set(order)) - 1  # logs of one run come one after another


def test_fewer_conditions_and_more_logs_change_no_log() -> None:
    whole, some = cells(trials=2, seed=9), cells(seed=9, conditions=("jitter", "robots-3"))
    assert {name: whole[name] for name in some} == some
    assert cells(seed=8)["jitter-motion-000"] != whole["jitter-motion-000"]
    assert whole["jitter-motion-000"].random.random() != whole["noise-2-motion-000"].random.random()


def test_the_ill_robot_is_in_every_log() -> None:
    for seed in range(20):
        found = cells(seed=seed)
        for cell in found.values():
            for one in cell.hidden:
                assert all(robot < cell.run.robots and robot % 2 == 0 for robot in one.robots)
        assert found["half-unlogged-motion-000"].looked_at == {0, 2, 4, 6, 8}
        assert found["robots-1-motion-000"].hidden[0].robots == (0,)


def test_what_cannot_be_asked_for_is_refused() -> None:
    with pytest.raises(InputError, match=r"--only: got 'row-of-3', expected .*row-of-2"):
        matrix_config(conditions=("row-of-3",))
    with pytest.raises(InputError, match="--trials: got 0"):
        matrix_config(trials=0)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--only", "row-of-3"), "--only"),
        (("--at-bars",), "--at-bars"),
        (("--crowd", "3"), "--crowd"),
        (("--kind", "pair"), "--kind: got pair"),
        (("--leave-one-out",), "--leave-one-out"),
        (("--seconds", "60"), "--seconds"),
        (("--build-spread", "0.01"), "--build-spread"),
        (("--trials", "0"), "--trials"),
    ],
)
def test_the_command_refuses_what_makes_no_sense_with_conditions(
    words: tuple[str, ...], said: str, tmp_path: Path
) -> None:
    asked = ["blind", "--conditions", *words, "--out", str(tmp_path / "out")]
    with pytest.raises(InputError, match=f"^{said}"):
        CliRunner().invoke(app, asked, catch_exceptions=False, standalone_mode=False)
    assert not (tmp_path / "out").exists()


MOTION, WELL = cells()["jitter-motion-000"], cells()["jitter-healthy-000"]
OWN = list(MOTION.hidden[0].robots)
OTHER = [9]


def answer(verdict: str, *causes: tuple[str, Any], size: float | None = 0.004) -> dict[str, Any]:
    known = {"parameter": "ratio", "unit": "1", "null": 1.0, "size": size, "robot": OWN[0]}
    return {
        "diagnosis": {
            "verdict": verdict,
            "causes": [
                {"name": name, "robots": robots, "parameters": {}, "alternatives": []}
                for name, robots in causes
            ],
            "unexplained": [],
            "detectable": {ILL["motion"]: known},
            "log": {"preflight": [], "cannot_tell": {}},
        },
        "error": None,
    }


def without(error: str) -> dict[str, Any]:
    return {"diagnosis": None, "error": error}


def as_a_rival() -> dict[str, Any]:
    said = answer("ambiguous", ("wheel_separation", OWN), size=None)
    said["diagnosis"]["causes"][0]["alternatives"] = [ILL["motion"]]
    return said


def worst_in_another() -> dict[str, Any]:
    said = answer("nothing_wrong", size=None)
    said["diagnosis"]["detectable"][ILL["motion"]]["robot"] = OTHER[0]
    return said


def silenced_by_preflight() -> dict[str, Any]:
    said = answer("nothing_wrong")
    entry = {"name": "n", "meaning": "m", "follows": "silences", "why": "rows miss commands"}
    said["diagnosis"]["log"]["preflight"] = [entry | {"causes": [ILL["motion"]]}]
    return said


def not_looked_for() -> dict[str, Any]:
    said = answer("nothing_wrong")
    said["diagnosis"]["detectable"] = {}
    return said


RIGHT, WRONG = (ILL["motion"], OWN), ("motor_lag", OTHER)
FLAGS = ("named", "wrong", "silenced", "refused", "crashed", "failing")


@pytest.mark.parametrize(
    ("cell", "said", "flags", "accused"),
    [
        (MOTION, answer("named", RIGHT), {"named"}, 0),
        (MOTION, answer("named", RIGHT, WRONG), {"named", "wrong", "failing"}, 1),
        (MOTION, answer("named", WRONG), {"wrong", "failing"}, 1),
        (MOTION, answer("nothing_wrong"), {"failing"}, 0),
        (MOTION, answer("nothing_wrong", size=0.0101), {"silenced"}, 0),
        (MOTION, answer("nothing_wrong", size=0.0099), {"failing"}, 0),
        (MOTION, answer("nothing_wrong", size=None), {"silenced"}, 0),
        (MOTION, as_a_rival(), {"failing"}, 0),
        (MOTION, worst_in_another(), {"failing"}, 0),
        (MOTION, answer("cannot_tell"), {"silenced"}, 0),
        (MOTION, silenced_by_preflight(), {"silenced"}, 0),
        (MOTION, not_looked_for(), {"silenced"}, 0),
        (MOTION, without("InputError: t: got a, expected b"), {"refused"}, 0),
        (MOTION, without("InputError: t: got a\nb"), {"crashed", "failing"}, 0),
        (MOTION, without("ValueError: nothing"), {"crashed", "failing"}, 0),
        (MOTION, without("no answer in 900 s"), {"crashed", "failing"}, 0),
        (WELL, answer("nothing_wrong"), set(), 0),
        (WELL, answer("named", WRONG), {"wrong", "failing"}, 1),
        (WELL, answer("named", ("motor_lag", "all")), {"wrong", "failing"}, 10),
        (WELL, without("InputError: t: got a, expected b"), {"refused"}, 0),
        (WELL, without("exit code 1"), {"crashed", "failing"}, 0),
    ],
)
def test_a_log_counts_as_what_was_said_of_it(
    cell: CellLog, said: dict[str, Any], flags: set[str], accused: int
) -> None:
    row = log_result(cell, said).row()
    assert {flag for flag in FLAGS if row[flag]} == flags
    assert row["accused"] == accused


def scored(cell: CellLog, *answers: dict[str, Any]) -> dict[str, Any]:
    results = [log_result(cell, one) for one in answers]
    return cells_of(logs_table(results))[0]


OK, MISSED, SILENT = answer("named", RIGHT), answer("nothing_wrong"), answer("cannot_tell")


def test_a_cell_passes_or_says_which_bars_it_misses() -> None:
    assert scored(MOTION, *[OK] * 8, *[MISSED] * 2)["misses"] == ""
    assert scored(MOTION, *[OK] * 7, *[MISSED] * 3)["misses"] == "missed"
    assert scored(MOTION, *[OK] * 8, MISSED, answer("named", WRONG))["misses"] == "accused wrong"
    assert scored(MOTION, *[OK] * 9, without("boom"))["misses"] == "crashed"
    well = answer("nothing_wrong")
    assert scored(WELL, *[well] * 9, answer("named", WRONG))["misses"] == "wrong"
    assert scored(WELL, *[well] * 9, answer("named", WRONG, (WRONG[0], [3])))["accused"] == 2
    assert scored(WELL, *[well] * 8, *[answer("named", WRONG)] * 2)["misses"] == "accused wrong"


def test_logs_that_are_silent_for_a_reason_are_not_missed_and_silence_a_cell_together() -> None:
    found = scored(MOTION, *[OK] * 4, *[SILENT] * 3)
    assert (found["misses"], found["is_silenced"], found["silenced"]) == ("", False, 3)
    found = scored(MOTION, *[OK] * 4, MISSED, *[SILENT] * 4)
    assert (found["misses"], found["is_silenced"]) == ("", False)
    found = scored(MOTION, *[OK] * 3, MISSED, SILENT)
    assert found["misses"] == "missed"
    found = scored(MOTION, OK, MISSED, SILENT, without("InputError: a: got b, expected c"))
    assert (found["misses"], found["is_silenced"]) == ("", True)
    wrong = scored(MOTION, SILENT, SILENT, answer("named", WRONG))
    assert wrong["misses"] == "accused wrong"
    assert not scored(WELL, SILENT)["is_silenced"]


def test_shares_of_accused_robots_carry_exact_intervals() -> None:
    found = scored(WELL, *[answer("nothing_wrong")] * 10)
    assert (found["healthy"], found["accused"], found["accused_low"]) == (100, 0, 0.0)
    assert found["accused_high"] == pytest.approx(1.0 - 0.025**0.01, abs=1e-4)


def results(*answers: tuple[str, dict[str, Any]]) -> list[LogResult]:
    found = cells()
    return [log_result(found[name], one) for name, one in answers]


def test_the_page_tells_every_cell_and_every_log_to_look_at() -> None:
    logs = logs_table(
        results(
            ("jitter-healthy-000", answer("named", WRONG)),
            ("jitter-motion-000", OK),
            ("no-yaw-motion-000", without("InputError: yaw: got nothing, expected numbers")),
        )
    )
    table = cells_of(logs)
    assert summary(table) == {
        "cells": 3, "passing": 2, "ill": 2, "silenced": 1,
        "accused": 1, "wrong": 1, "missed": 0, "crashed": 0,
    }  # fmt: skip
    told = as_told(table).set_index("condition")
    assert told.loc["jitter", "healthy"] == "✗ accused 1/10, wrong 1"
    assert told.loc["jitter", "motion"] == "named 1/1, accused 0/9"
    assert told.loc["no-yaw", "motion"] == "named 0/1, refused 1"
    assert told.loc["no-yaw", "light"] == "–"
    bad = failures(logs)
    assert bad["log"].tolist() == ["jitter-healthy 0"]
    assert bad["answer"].tolist() == ["named; motor_lag of 9:"]


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """A matrix of runs of two seconds, diagnosed by a stub that fails without light sensors."""
    out = tmp_path_factory.mktemp("conditions") / "out"
    return out, again(out, trials=1)


def again(out: Path, jobs: int = 1, **asked: Any) -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(matrix, "SECONDS", 2.0)
        config = matrix_config(**{"seed": 2, "conditions": STUBBED, **asked})
        return run_matrix(config, out, Workers(jobs), quiet=True, diagnosed=ask_stub)


def answers_in(out: Path) -> dict[str, Any]:
    timeless = {"record_seconds": 0, "diagnose_seconds": 0}
    return {
        path.parent.name: json.loads(path.read_text()) | timeless
        for path in (out / "trials").glob("*/trial.json")
    }


def test_a_matrix_writes_its_tables_and_its_page(
    small: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    out, content = small
    assert json.loads((out / "conditions.json").read_text()) == content
    assert len(content["cells"]) == len(pd.read_csv(out / "cells.csv")) == 4 * len(STUBBED)
    logs = pd.read_csv(out / "logs.csv")
    assert logs[logs["crashed"]]["condition"].unique().tolist() == ["no-sensors"]
    assert logs["said"][logs["crashed"]].eq("ValueError: no light sensors").all()
    assert (logs[logs["condition"] == "robots-2"]["healthy"] <= 2).all()
    text = (out / "conditions.md").read_text()
    assert text.startswith(f"# {TITLE}\n\n{MARK}\n")
    assert "--trials 1 --seed 2 --only as-recorded" in text
    page = (out / "report.html").read_text()
    assert TITLE in page
    assert "`" not in re.sub(r"<style>.*?</style>", "", page, flags=re.DOTALL)
    if CHROMIUM is not None:
        check_fits(out / "report.html", tmp_path)


def test_a_resumed_matrix_repeats_nothing_and_may_grow(
    small: tuple[Path, dict[str, Any]],
) -> None:
    out, content = small
    before = {path: path.stat().st_mtime_ns for path in (out / "trials").glob("*/*")}
    more = again(out, trials=2, conditions=("as-recorded", "jitter"))
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert [one["logs"] for one in more["cells"]] == [2] * 8
    assert again(out, trials=1) == content
    with pytest.raises(InputError, match="seed 2 there, 3 now"):
        again(out, seed=3)


def test_answers_do_not_depend_on_the_workers(
    small: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    again(tmp_path / "two", jobs=2, trials=1)
    made = answers_in(tmp_path / "two")
    assert made == {name: one for name, one in answers_in(small[0]).items() if name in made}


@pytest.mark.blind
def test_in_logs_as_they_are_recorded_nobody_is_accused_and_each_effect_is_named(
    tmp_path: Path,
) -> None:
    config = matrix_config(trials=1, seed=30101, conditions=("as-recorded",))
    found = run_matrix(config, tmp_path / "out", Workers(1), quiet=True)["cells"]
    assert [(one["state"], one["misses"]) for one in found] == [(state, "") for state in STATES]
    assert [one["named"] for one in found] == [0, 1, 1, 1]


def test_the_document_is_of_the_conditions_there_are() -> None:
    text = (ROOT / "docs" / "conditions.md").read_text(encoding="utf-8")
    assert text.startswith(f"# {TITLE}\n\n{MARK}\n"), "copy conditions.md of a whole matrix"
    rows = dict(re.findall(r"^\| ([a-z0-9.-]+) \| ([^|]+) \|", text, flags=re.MULTILINE))
    said = {name: rows.get(name) for name in CONDITIONS}
    assert said == {name: one.meaning for name, one in CONDITIONS.items()}

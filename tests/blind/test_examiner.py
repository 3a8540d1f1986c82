"""An examiner answers as `realitygap diagnose` does, from the log alone, and outlives its forks."""

from __future__ import annotations

import json
import os
import shutil
import signal
from pathlib import Path

import pytest

from studies.blind import examiner
from studies.blind.examiner import LOG, ask
from studies.blind.record import diagnose
from studies.experiment import RunConfig, simulate


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> Path:
    run, given = (tmp_path_factory.mktemp(name) for name in ("run", "given"))
    latency = "command_latency:seconds=0.1,robot=1"
    simulate(RunConfig(minutes=0.5, robots=3, seed=5, controller="search"), (latency,), run)
    shutil.move(run / LOG, given / LOG)
    return given


def test_an_answer_is_what_the_command_writes(given: Path, tmp_path: Path) -> None:
    shutil.copy(given / LOG, tmp_path / LOG)
    written, error = diagnose(tmp_path)
    assert (written, error) == (
        json.loads((tmp_path / "diagnosis/diagnosis.json").read_text()),
        None,
    )
    assert written is not None
    assert written["causes"][0]["name"] == "command_latency"
    answers = [ask(given), ask(given, ("command_latency",)), ask(given)]
    assert answers[0] == answers[2] == (written, None)
    assert answers[1] != answers[0]
    assert [path.name for path in given.iterdir()] == [LOG]


def test_a_log_that_cannot_be_read_is_an_answer(tmp_path: Path) -> None:
    (tmp_path / LOG).write_bytes(b"no table")
    answer, error = ask(tmp_path)
    assert answer is None
    assert error is not None
    assert error.startswith("InputError: ")
    assert LOG in error


def test_after_an_examiner_has_died_another_answers(given: Path) -> None:
    assert ask(given)[1] is None
    process = examiner._examiner().process
    assert process is not None
    os.killpg(process.pid, signal.SIGKILL)
    assert ask(given) == (None, "the examiner died")
    assert ask(given)[1] is None


def test_no_answer_in_time_is_an_answer(given: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(examiner, "TIMEOUT", 0.01)
    assert ask(given) == (None, "no answer in 0 s")
    monkeypatch.undo()
    assert ask(given)[1] is None

"""An examiner answers as `realitygap diagnose` does, from the log alone, and outlives its forks."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest

from realitygap.studies.blind import examiner
from realitygap.studies.blind.examiner import LOG, ask
from realitygap.studies.blind.record import diagnose
from realitygap.studies.run.experiment import RunConfig, simulate
from tests.helpers import ROOT, children, until, wait_until_gone


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
    assert [ask(given, (), name)[0] == written for name in ("pybullet", "mujoco")] == [True, False]
    assert [path.name for path in given.iterdir()] == [LOG]


def test_a_model_beside_the_log_is_what_the_diagnosis_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By an examiner's fork, and by the command."""
    monkeypatch.chdir(tmp_path)
    asked = []
    for model in (None, "extended.toml"):
        if model:
            (tmp_path / model).write_text("")
        examiner._answer(
            lambda log, **how: asked.append((log, how["model"])) or SimpleNamespace(content={}),
            tmp_path,
            tmp_path / "answer.json",
        )
    assert asked == [(LOG, None), (LOG, "extended.toml")]
    code = "import json, os, sys; os.mkdir('diagnosis'); "
    code += "json.dump(sys.argv[1:], open('diagnosis/diagnosis.json', 'w'))"
    answer, _ = diagnose(tmp_path, command=(sys.executable, "-c", code))
    assert answer == [LOG, "--out", "diagnosis", "--model", "extended.toml"]


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
    assert ask(given)[1] is None


def test_a_killed_fork_is_no_answer_about_the_log_but_killing_always_ends_it(
    given: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started = []

    def deadly() -> subprocess.Popen[str]:
        started.append(True)
        return subprocess.Popen(["true"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    examiner._examiner().stop()
    monkeypatch.setattr(examiner, "_started", deadly)
    assert ask(given) == (None, "the examiner died")
    assert len(started) == examiner.TRIES


def test_threads_and_interrupted_questions_get_their_own_answers(
    given: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = ask(given)
    with ThreadPoolExecutor(2) as pool:
        answers = list(pool.map(ask, [given, tmp_path, given, tmp_path]))
    assert answers[0] == answers[2] == whole
    assert all(answer is None and LOG in error for answer, error in answers[1::2])

    def interrupted(*lists: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(examiner, "select", interrupted)
        with pytest.raises(KeyboardInterrupt):
            ask(tmp_path)
    assert ask(given) == whole


def test_an_examiner_ends_with_whoever_asked_and_its_fork_with_it(given: Path) -> None:
    asker = subprocess.Popen(
        [sys.executable, "-c", ASK, str(given)], stdout=subprocess.PIPE, cwd=ROOT, text=True
    )
    assert asker.stdout is not None
    pid = int(asker.stdout.readline())
    until(lambda: children(pid))
    fork = children(pid)
    asker.kill()
    asker.communicate()
    for each in (pid, *fork):
        wait_until_gone(each)


ASK = """
import sys, threading
from pathlib import Path
from realitygap.studies.blind import examiner
threading.Thread(target=examiner.ask, args=(Path(sys.argv[1]),), daemon=True).start()
while examiner._examiner().process is None: pass
print(examiner._examiner().process.pid, flush=True)
threading.Event().wait()
"""


def test_no_answer_in_time_is_an_answer(given: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(examiner, "TIMEOUT", 0.01)
    assert ask(given) == (None, "no answer in 0 s")
    monkeypatch.undo()
    assert ask(given)[1] is None


def test_an_interrupt_of_an_examiner_that_is_just_starting_changes_nothing() -> None:
    process = examiner._started()
    try:
        for _ in range(20):
            process.send_signal(signal.SIGINT)
            time.sleep(0.02)
        assert process.poll() is None
    finally:
        process.kill()
        process.communicate()

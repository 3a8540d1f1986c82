"""Processes end with their parent, commands clean up after a signal, and what they say fits."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from realitygap.studies.plumbing.execution import processes
from realitygap.studies.plumbing.lifetime import Ended, listening, shielded, tied
from tests.helpers import COMMAND, ENVIRONMENT, LONG, ROOT, until, wait_until_gone

PARENT = """
import subprocess, sys
from pathlib import Path
from realitygap.studies.blind.record import diagnose
from realitygap.studies.plumbing.execution import Workers, completed
from realitygap.studies.plumbing.lifetime import tied
from tests.studies.test_lifetime import FOREVER, say_and_wait
what, here = sys.argv[1], Path(sys.argv[2])
if what == "command":
    subprocess.run(tied((sys.executable, "-c", FOREVER)), cwd=here)
elif what == "diagnosis":
    diagnose(here, command=(sys.executable, "-c", FOREVER))
else:
    list(completed(say_and_wait, [here], Workers(1)))
"""
FOREVER = """
import os, signal
open("part", "w").write(str(os.getpid()))
os.rename("part", "pid")
signal.sigwait({signal.SIGUSR2})
"""


def say_and_wait(here: Path) -> None:
    """In a worker: without end, and as a C loop that no thread interrupts."""
    os.chdir(here)
    exec(FOREVER)


@pytest.mark.parametrize("what", ["command", "worker", "diagnosis"])
def test_a_child_ends_with_its_killed_parent(what: str, tmp_path: Path) -> None:
    words = [sys.executable, "-c", PARENT, what, str(tmp_path)]
    parent = subprocess.Popen(words, cwd=ROOT, env=ENVIRONMENT)
    until((tmp_path / "pid").exists)
    child = int((tmp_path / "pid").read_text())
    os.kill(child, 0)
    parent.kill()
    parent.wait()
    wait_until_gone(child)


def test_a_killed_command_with_workers_says_nothing(tmp_path: Path) -> None:
    words = [sys.executable, "-c", PARENT, "worker", str(tmp_path)]
    parent = subprocess.Popen(words, cwd=ROOT, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True)
    until((tmp_path / "pid").exists)
    parent.kill()
    _, said = parent.communicate(timeout=LONG)  # until all who could say something have ended
    assert said == ""


def test_a_tied_command_is_the_command() -> None:
    done = subprocess.run(
        tied((sys.executable, "-c", "import sys; print(sys.argv[1:]); sys.exit(3)", "a b", "é")),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (3, "['a b', 'é']\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_is_told_once_what_must_not_be_half_done_is_done(number: signal.Signals) -> None:
    done = []
    with listening(), pytest.raises(Ended) as ended:  # noqa: PT012 - where it is raised matters
        with shielded():
            with shielded():
                signal.raise_signal(number)
                signal.raise_signal(signal.SIGTERM)
                done.append("inner")
            done.append("outer")
        done.append("more")
    assert done == ["inner", "outer"]
    assert ended.value.number == number


def test_what_another_thread_does_keeps_no_signal_from_the_command() -> None:
    inside, told = threading.Event(), threading.Event()

    def keep() -> None:
        with shielded():
            inside.set()
            told.wait(LONG)

    other = threading.Thread(target=keep)
    with listening():
        other.start()
        inside.wait(LONG)
        try:
            with pytest.raises(Ended):
                signal.raise_signal(signal.SIGTERM)
        finally:
            told.set()
            other.join()


def test_a_signal_that_was_swallowed_is_told_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("realitygap.studies.plumbing.lifetime.AGAIN", 0.01)
    with listening(), pytest.raises(Ended):  # noqa: PT012 - where it is raised matters
        with contextlib.suppress(BaseException):
            signal.raise_signal(signal.SIGTERM)
        end = time.monotonic() + LONG
        while time.monotonic() < end:
            pass


def test_what_cleans_up_after_a_signal_is_not_told_of_it_again() -> None:
    done = []
    with listening(), pytest.raises(Ended):  # noqa: PT012 - where it is raised matters
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            with shielded():
                done.append("room closed")
            done.append("note written")
    assert done == ["room closed", "note written"]


def test_what_a_shell_lets_be_ignored_stays_ignored_and_handlers_come_back() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with listening():
            signal.raise_signal(signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
        assert signal.getsignal(signal.SIGINT) == signal.default_int_handler
    finally:
        signal.signal(signal.SIGHUP, before)


def shell(line: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a line of shell in which $RG is the command."""
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", line.replace("$RG", '"$@"'), "-", *COMMAND],
        cwd=cwd,
        # under a limit on files, Python would cut off what it compiled and take it for whole later
        env={**ENVIRONMENT, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


RUN = "$RG run --minutes 0.05 --robots 2 --out out"


@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ("$RG effects --quiet > /dev/full", 1, "cannot write to standard output: No space left"),
        ("$RG effects --quiet >&-", 1, "cannot write to standard output: Bad file descriptor"),
        ("$RG effects > /dev/full 2> /dev/full", 1, ""),
        ("$RG effects >&- 2>&- <&-", 1, ""),
        ("$RG effects --no-such 2>&-", 2, ""),
        ("$RG effects --no-such 2>/dev/full", 2, ""),
        ("$RG effects | head -n 1 > /dev/null", 0, ""),
        ("$RG effects --help | true", 0, ""),
        (f"ulimit -f 1; {RUN} --quiet", 1, "File too large"),
        (f"{RUN} >&- 2>&-", 1, ""),
        (f"{RUN} --quiet >&- 2>&- <&-", 0, ""),
    ],
)
def test_output_that_cannot_be_written_is_one_line_and_exit_code_1(
    tmp_path: Path, line: str, code: int, said: str
) -> None:
    done = shell(line, tmp_path)
    assert done.returncode == code, done.stderr
    assert len(done.stderr.splitlines()) == bool(said), done.stderr
    assert said in done.stderr
    if "ulimit" in line:
        assert not list(tmp_path.iterdir())
    elif RUN in line:  # what cannot be said is no reason to lose what was computed
        assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_text_that_an_encoding_lacks_is_shown_by_its_number(tmp_path: Path) -> None:
    done = subprocess.run(
        [*COMMAND, "run", "--model", "caf\N{LATIN SMALL LETTER E WITH ACUTE}", "--out", "out"],
        cwd=tmp_path,
        env={**ENVIRONMENT, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "caf\\xe9" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_an_interrupt_of_a_worker_that_is_just_starting_changes_nothing() -> None:
    with processes(1) as pool:
        answer = pool.submit(abs, -3)
        (worker,) = multiprocessing.active_children()
        assert worker.pid is not None
        os.kill(worker.pid, signal.SIGINT)
        assert answer.result(timeout=60.0) == 3

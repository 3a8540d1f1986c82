"""Diagnoses by processes that get a log alone, without starting Python anew for each.

An examiner is a process of its own that loads the diagnosis and nothing of the trial, is told a
directory and causes to do without, and forks: the fork diagnoses the log there, writes its answer
into a file and is gone, so that no log's diagnosis knows of another's. It ends with whoever asked,
and its fork with it.
"""

from __future__ import annotations

import atexit
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from select import select
from threading import Lock
from typing import TYPE_CHECKING, Any

from realitygap.studies.plumbing.lifetime import deaf, end_with, tied
from realitygap.studies.plumbing.rooms import scratch

if TYPE_CHECKING:
    from realitygap.studies.diagnosis.result import DiagnosisResult

LOG = "samples.parquet"
MODEL = "extended.toml"
"""In the directory of a log: what the diagnosis is told of the robots; absent: the e-puck."""
TIMEOUT = 900.0
"""s for one diagnosis; our choice."""
TRIES = 3
"""Times a question is asked if whoever should answer is killed; our choice, as of worker pools."""
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
"""One thread per library: results do not depend on the cores."""

Answer = tuple[dict[str, Any] | None, str | None]
"""The content of `diagnosis.json`, or what went wrong."""


class Killed(Exception):
    """Whoever should answer was killed: that says nothing about the log."""


class _Examiner:
    """The process, started when first asked; one question at a time, whatever the threads."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[str] | None = None
        self._asked = 0
        self._one_at_a_time = Lock()
        # it ends with the thread that starts it: one that lasts as long as this process
        self._starter = ThreadPoolExecutor(1)

    def ask(self, given: Path, withheld: tuple[str, ...], reference: str | None) -> Answer:
        """Its answer; after none in time, or a death, the next question gets a new process."""
        with self._one_at_a_time, scratch() as room:
            answer = room / "answer.json"
            question = [str(given), withheld, reference, str(answer)]
            try:
                error = self._failure(question)
            except BaseException:
                self.stop()  # or the next question would get this one's answer
                raise
            if error is not None:
                return None, error
            diagnosis, error = json.loads(answer.read_text(encoding="utf-8"))
            return diagnosis, error

    def _failure(self, question: list[Any]) -> str | None:
        """Ask, again if somebody is killed meanwhile, and say what kept the answer away."""
        for _ in range(TRIES):
            try:
                return self._tried(question)
            except Killed as killed:
                error = str(killed)
        return error

    def _tried(self, question: list[Any]) -> str | None:
        """Ask once, wait, and say what kept the fork from writing its answer.

        Raises:
            Killed: the examiner or its fork was killed, by whatever.
        """
        if self.process is None:
            self.process = self._starter.submit(_started).result()
        told, answers = self.process.stdin, self.process.stdout
        assert told is not None
        assert answers is not None
        self._asked += 1
        with suppress(BrokenPipeError):
            told.write(json.dumps([self._asked, *question]) + "\n")
            told.flush()
        in_time = select([answers], [], [], TIMEOUT)[0]
        line = answers.readline() if in_time else ""
        if not line:
            self.stop()
            if in_time:
                raise Killed("the examiner died")
            return f"no answer in {TIMEOUT:.0f} s"
        number, code = json.loads(line)
        assert number == self._asked
        if code < 0:
            raise Killed(f"exit code {code}")
        return f"exit code {code}" if code else None

    def stop(self) -> None:
        """End the process and what it has forked."""
        if self.process is not None:
            with suppress(ProcessLookupError, BrokenPipeError), self.process:
                os.killpg(self.process.pid, signal.SIGKILL)
            self.process = None


@cache
def _examiner() -> _Examiner:
    """This process's own."""
    one = _Examiner()
    atexit.register(one.stop)
    return one


def ask(given: Path, withheld: tuple[str, ...] = (), reference: str | None = None) -> Answer:
    """A diagnosis of the log in a directory where nothing else is but, maybe, a model.

    Args:
        given: The directory.
        withheld: Causes that it must do without.
        reference: Healthy reference that it must do with; None: the one that it finds.
    """
    return _examiner().ask(given, withheld, reference)


def _started() -> subprocess.Popen[str]:
    """A session of its own: an interrupt is for who asks, whose end it sees."""
    command = (sys.executable, "-c", "from realitygap.studies.blind.examiner import serve; serve()")
    with deaf():
        return subprocess.Popen(
            tied(command),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, **THREADS},
            text=True,
            start_new_session=True,
        )


def serve() -> None:
    """Answer every line of standard input, a question, with its number and an exit code."""
    from realitygap.studies.diagnosis.diagnose import diagnose  # loaded once, before any fork

    examiner = os.getpid()
    for line in sys.stdin:
        number, given, withheld, reference, answer = json.loads(line)
        child = os.fork()
        if child == 0:
            end_with(examiner)
            os.dup2(2, 1)  # what a library may print is no answer
            try:
                asked = partial(diagnose, without=tuple(withheld), reference=reference)
                _answer(asked, Path(given), Path(answer))
            except BaseException as error:
                sys.stderr.write(f"examiner: {type(error).__name__}: {error}\n")
                os._exit(1)
            os._exit(0)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        with suppress(BrokenPipeError):  # nobody is left to hear it, as the next line will tell
            sys.stdout.write(json.dumps([number, code]) + "\n")
            sys.stdout.flush()


def _answer(diagnose: Callable[..., DiagnosisResult], given: Path, answer: Path) -> None:
    os.chdir(given)
    said: Answer
    try:
        model = MODEL if Path(MODEL).is_file() else None
        said = dict(diagnose(LOG, model=model).content), None
    except Exception as error:
        said = None, f"{type(error).__name__}: {error}"
    answer.write_text(json.dumps(said, allow_nan=False), encoding="utf-8")

"""Diagnoses by processes that get a log alone, without starting Python anew for each.

An examiner is a process of its own that loads the diagnosis and nothing of the trial, is told a
directory and causes to do without, and forks: the fork diagnoses the log there, answers and is
gone, so that no log's diagnosis knows of another's. It ends with whoever asked.
"""

from __future__ import annotations

import atexit
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from select import select
from typing import Any

from studies.diagnosis_request import Request

LOG = "samples.parquet"
TIMEOUT = 900.0
"""s for one diagnosis; our choice."""
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
"""One thread per library: results do not depend on the cores, and forks are safe."""

Answer = tuple[dict[str, Any] | None, str | None]
"""The content of `diagnosis.json`, or what went wrong."""


class _Examiner:
    """The process, started when first asked."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[str] | None = None

    def ask(self, given: Path, withheld: tuple[str, ...]) -> Answer:
        """Its answer; after none in time, or a death, the next question gets a new process."""
        if self.process is None:
            self.process = _started()
        told, answers = self.process.stdin, self.process.stdout
        assert told is not None
        assert answers is not None
        with suppress(BrokenPipeError):
            told.write(json.dumps([str(given), withheld]) + "\n")
            told.flush()
        in_time = select([answers], [], [], TIMEOUT)[0]
        line = answers.readline() if in_time else ""
        if not line:
            self.stop()
            return None, "the examiner died" if in_time else f"no answer in {TIMEOUT:.0f} s"
        diagnosis, error = json.loads(line)
        return diagnosis, error

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


def ask(given: Path, withheld: tuple[str, ...] = ()) -> Answer:
    """A diagnosis of the log in a directory where nothing else is.

    Args:
        given: The directory.
        withheld: Causes that it must do without.
    """
    return _examiner().ask(given, withheld)


def _started() -> subprocess.Popen[str]:
    """A session of its own: an interrupt is for who asks, whose end it sees."""
    return subprocess.Popen(
        [sys.executable, "-c", "from studies.blind.examiner import serve; serve()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, **THREADS},
        text=True,
        start_new_session=True,
    )


def serve() -> None:
    """Answer every line of standard input with a line, until there are no more."""
    from studies.diagnosis_files import content_of  # loaded once, before any fork

    for line in sys.stdin:
        given, withheld = json.loads(line)
        child = os.fork()
        if child == 0:
            code = 1
            try:
                _say(_diagnosed(content_of, Path(given), tuple(withheld)))
                code = 0
            finally:
                os._exit(code)
        _, status = os.waitpid(child, 0)
        if status:
            _say((None, f"exit code {os.waitstatus_to_exitcode(status)}"))


def _diagnosed(
    content_of: Callable[[Request], dict[str, Any]], given: Path, withheld: tuple[str, ...]
) -> Answer:
    os.chdir(given)
    try:
        return content_of(Request(logs=(Path(LOG),), without=withheld)), None
    except Exception as error:
        return None, f"{type(error).__name__}: {error}"


def _say(answer: Answer) -> None:
    sys.stdout.write(json.dumps(answer, allow_nan=False) + "\n")
    sys.stdout.flush()

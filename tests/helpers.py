"""What several tests need: the command line as a user runs it."""

from __future__ import annotations

import html
import logging
import os
import re
import select
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import NoReturn

import realitygap as door

ROOT = Path(__file__).parents[1]
COMMAND = [sys.executable, "-c", "from realitygap.studies.cli import main; main()"]
"""`realitygap`, with this interpreter."""
ENVIRONMENT = {
    "PYTHONPATH": str(ROOT),
    "PATH": "/usr/bin:/bin",
    "COLUMNS": "200",
    # how linear algebra is set belongs to the machine: other kernels give other last digits
    **{name: value for name, value in os.environ.items() if name.startswith("OPENBLAS_")},
}


def page_text(page: Path) -> str:
    """What a page says, without what explains its words."""
    return html.unescape(re.sub(r"</?abbr[^>]*>", "", page.read_text(encoding="utf-8")))


LONG = 300.0
"""s that something may take on a machine that is very busy; nothing waits so long for success."""


def until(condition: Callable[[], object]) -> None:
    """Wait for something to become so."""
    end = time.monotonic() + LONG
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def children(pid: int) -> set[int]:
    """Processes below one, by Linux's /proc."""
    found = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            child = int(stat.parent.name)
            found |= {child} | children(child)
    return found


def wait_until_gone(pid: int) -> None:
    """Wait for the end of a process that need not be ours; a zombie has ended."""
    try:
        handle = os.pidfd_open(pid)
    except ProcessLookupError:
        return
    try:
        assert select.select([handle], [], [], LONG)[0], f"process {pid} is left"
    finally:
        os.close(handle)


def realitygap(*words: object, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run a command to its end in a process of its own: a fork, which has its libraries already.

    A warning ends it, as it ends a test. Tests of how a process starts run `COMMAND`.
    """
    given = [*map(str, words)]
    for name in door.__all__:
        getattr(door, name)  # imports it, the first time
    with TemporaryFile() as out, TemporaryFile() as err:
        pid = os.fork()
        if pid == 0:
            _become(given, cwd, out.fileno(), err.fileno())
        try:
            wait_until_gone(pid)
        finally:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        told = []
        for stream in (out, err):
            stream.seek(0)
            told.append(stream.read().decode("utf-8").replace("\r\n", "\n"))
    return subprocess.CompletedProcess(given, code, *told)


def _become(words: list[str], cwd: Path, out: int, err: int) -> NoReturn:
    """What `COMMAND` is in a process that has just been forked from the tests."""
    code: object = 1
    try:
        for target, (stream, name) in enumerate([(out, "stdout"), (err, "stderr")], start=1):
            os.dup2(stream, target)
            text = open(target, "w", encoding="utf-8", closefd=False)  # noqa: SIM115, until the end
            setattr(sys, name, text)
            setattr(sys, f"__{name}__", text)
        os.chdir(cwd)
        os.environ.clear()
        os.environ.update(ENVIRONMENT)
        logging.root.handlers.clear()
        sys.argv = [COMMAND[1], *words]
        from realitygap.studies.cli import main

        main()
    except SystemExit as ended:
        code = ended.code or 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code if isinstance(code, int) else 1)

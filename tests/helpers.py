"""What several tests need: the command line as a user runs it."""

from __future__ import annotations

import html
import os
import re
import select
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

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
    """Run a command to its end."""
    return subprocess.run(
        [*COMMAND, *map(str, words)],
        cwd=cwd,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )

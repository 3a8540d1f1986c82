"""Kept logs and what is said of them.

    python -m tests.golden logs [NAME...]      record the logs anew
    python -m tests.golden answers [NAME...]   keep what is said of them now
    python -m tests.golden compare [NAME...]   a table of what is said otherwise than is kept

NAME is a log of `tests.golden.plan`, or the beginning of its name; all of them if absent.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from typer import echo

from realitygap.studies.blind.examiner import THREADS
from realitygap.studies.plumbing.execution import Workers, completed
from tests.golden.answers import ANSWERS, LOGS, answer, answer_file, differences, log_file
from tests.golden.logs import make
from tests.golden.plan import plan

Made = TypeVar("Made")


def each(work: Callable[[str], Made], names: Sequence[str]) -> Iterator[tuple[str, Made]]:
    """Do something with every log on all cores; names and what came out, in whatever order.

    Raises:
        RuntimeError: the first that cannot be done.
    """
    os.environ.update(THREADS)
    for done in completed(work, names, Workers.chosen(None, None)):
        if done.value is None:
            raise RuntimeError(f"{done.task}: {done.error}")
        echo(f"{done.cpu_seconds:6.1f} s  {done.task}", err=True)
        yield done.task, done.value


def logs(names: Sequence[str]) -> None:
    """Record and keep logs."""
    LOGS.mkdir(exist_ok=True)
    for name, content in each(make, names):
        log_file(name).write_bytes(content)


def answers(names: Sequence[str]) -> None:
    """Keep what is said."""
    ANSWERS.mkdir(exist_ok=True)
    for name, text in each(answer, names):
        answer_file(name).write_text(text, encoding="utf-8")


def compare(names: Sequence[str]) -> None:
    """Print a table of what is said otherwise."""
    now = dict(each(answer, names))
    kept = {name: answer_file(name).read_text(encoding="utf-8") for name in names}
    changed = [name for name in names if now[name] != kept[name]]
    echo("| log | what | kept | now |\n|---|---|---|---|")
    for name in changed:
        for row in differences(name, json.loads(kept[name]), json.loads(now[name])):
            echo("| " + " | ".join(row) + " |")
    echo(f"\n{len(changed)} of {len(names)} answers differ")


def main(words: Sequence[str]) -> int:
    """Do what a word says; 2 if there is no such word or log."""
    todo = {"logs": logs, "answers": answers, "compare": compare}
    names = [name for name in plan() if not words[1:] or name.startswith(tuple(words[1:]))]
    if not words or words[0] not in todo or not names:
        echo(__doc__, err=True)
        return 2
    began = time.perf_counter()
    todo[words[0]](names)
    echo(f"{len(names)} logs in {time.perf_counter() - began:.0f} s", err=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

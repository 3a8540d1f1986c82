"""What a battery lacks is done: each trial by a worker, and kept as it ends."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from typing import Any

from realitygap.studies.blind.directory import BlindDirectory
from realitygap.studies.blind.record import Diagnosed, Task
from realitygap.studies.plumbing.execution import Unfinished, Workers
from realitygap.studies.plumbing.manifest import made
from realitygap.studies.plumbing.progress import Progress


class TrialsFailed(Unfinished):
    """Some trials could not be recorded; the others are kept."""


def do_missing(
    directory: BlindDirectory[Any],
    workers: Workers,
    quiet: bool,
    diagnosed: Diagnosed,
    work: Callable[[Task], dict[str, Any]],
) -> None:
    """Do the trials that are missing.

    Args:
        directory: Held.
        workers: Where.
        quiet: Say nothing.
        diagnosed: What diagnoses; importable.
        work: What a worker does with a trial.

    Raises:
        TrialsFailed: trials raised errors of their own.
        WorkersLost: workers keep dying.
    """
    flaws: list[str] = []
    tasks = [Task(trial, diagnosed) for trial in directory.pending(flaws.append)]
    if not tasks:
        return
    failures = []
    total = sum(task.trial.seconds for task in tasks)
    done = 0.0
    with (
        Progress("trials", total, quiet) as shown,
        closing(made(work, tasks, workers, note=shown.say)) as finished,
    ):
        for flaw in flaws:
            shown.say(flaw)
        for one in finished:
            trial = one.task.trial
            done += trial.seconds
            if one.value is None:
                failures.append(f"trial {trial.name}: {one.error}")
            else:
                directory.keep(trial, one.value)
            shown.reach(done)
    if failures:
        raise TrialsFailed(f"{len(failures)} trials failed, first {failures[0]}")

"""A battery from beginning to end: the trials that are missing, then the scores and the page."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Any

from realitygap.studies.blind.directory import BlindDirectory
from realitygap.studies.blind.examiner import ask
from realitygap.studies.blind.record import Diagnosed, Task, run_trial
from realitygap.studies.blind.report import write_report
from realitygap.studies.blind.summary import summarise
from realitygap.studies.blind.trials import BlindConfig, plan
from realitygap.studies.execution import Unfinished, Workers
from realitygap.studies.manifest import made
from realitygap.studies.output import whole_file
from realitygap.studies.progress import Progress
from realitygap.studies.provenance import write_json


class TrialsFailed(Unfinished):
    """Some trials could not be recorded; the others are kept."""


def run_battery(
    config: BlindConfig,
    out: Path,
    workers: Workers,
    *,
    quiet: bool = False,
    diagnosed: Diagnosed = ask,
) -> dict[str, Any]:
    """Run or resume a battery in `out`; returns the content of `blind.json`.

    Args:
        config: Which trials.
        out: The battery's directory.
        workers: Where trials run; each records and has its log diagnosed.
        quiet: Say nothing.
        diagnosed: What diagnoses the log in a directory; importable.

    Raises:
        InputError: `out` cannot be used.
        TrialsFailed: trials raised errors of their own; a failed diagnosis is a result.
        WorkersLost: workers keep dying.
    """
    with BlindDirectory(out, config, plan(config)).held() as directory:
        _execute(directory, workers, quiet, diagnosed)
        summary = summarise(directory)
        with whole_file(out / "blind.json", force=True) as part:
            write_json(part, summary)
        write_report(directory, summary)
    return summary


def _execute(
    directory: BlindDirectory, workers: Workers, quiet: bool, diagnosed: Diagnosed
) -> None:
    """Do the trials that are missing."""
    flaws: list[str] = []
    tasks = [Task(trial, diagnosed) for trial in directory.pending(flaws.append)]
    if not tasks:
        return
    failures = []
    total = sum(task.trial.seconds for task in tasks)
    done = 0.0
    with (
        Progress("trials", total, quiet) as shown,
        closing(made(run_trial, tasks, workers, note=shown.say)) as finished,
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

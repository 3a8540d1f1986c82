"""One trial: a run with something hidden, and a diagnosis by a process that gets the log alone."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from realitygap.studies.blind.examiner import LOG, MODEL, THREADS, TIMEOUT, Answer, ask
from realitygap.studies.blind.trials import Trial
from realitygap.studies.blind.unlisted import UNLISTED
from realitygap.studies.plumbing.lifetime import tied
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import ANONYMOUS, RunConfig, simulate

COMMAND = (sys.executable, "-c", "from realitygap.studies.cli import main; main()", "diagnose")
"""`realitygap diagnose`, by this interpreter."""

Diagnosed = Callable[[Path, tuple[str, ...]], Answer]


@dataclass(frozen=True)
class Task:
    """A trial and who diagnoses it."""

    trial: Trial
    diagnosed: Diagnosed = ask
    """Called with the directory of the log and the causes to do without."""


def run_trial(task: Task) -> dict[str, Any]:
    """Record, forget what was hidden, diagnose: see `answered`. Executed by a worker."""
    trial = task.trial
    return answered(task, lambda given: record(trial.run, trial.specs, given / LOG))


def answered(task: Task, write: Callable[[Path], None]) -> dict[str, Any]:
    """What is said of a trial whose log `write` puts into an empty directory.

    Returns:
        `diagnosis` (None if it failed), `error`, and s of wall time of both parts.
    """
    with scratch() as given:
        began = time.perf_counter()
        write(given)
        recorded = time.perf_counter()
        diagnosis, error = task.diagnosed(given, task.trial.withheld)
        return {
            "diagnosis": diagnosis,
            "error": error,
            "record_seconds": round(recorded - began, 3),
            "diagnose_seconds": round(time.perf_counter() - recorded, 3),
        }


def record(config: RunConfig, effects: tuple[str, ...], log: Path) -> None:
    """Simulate with something hidden and keep `log` alone, which does not say what run it is of."""
    with scratch() as run:
        simulate(config, effects, run, unlisted=UNLISTED, name=ANONYMOUS)
        shutil.move(run / LOG, log)


def diagnose(
    given: Path, withheld: tuple[str, ...] = (), *, command: tuple[str, ...] = COMMAND
) -> Answer:
    """As `ask`, with all files that `realitygap diagnose` writes, in `given / "diagnosis"`.

    Args:
        given: The directory.
        withheld: Causes that it must do without.
        command: What diagnoses, called with the log's name and `--out`.
    """
    words = [word for name in withheld for word in ("--without", name)]
    words += ["--model", MODEL] if (given / MODEL).is_file() else []
    try:
        done = subprocess.run(
            tied((*command, LOG, "--out", "diagnosis", *words)),
            cwd=given,
            env={**os.environ, **THREADS},
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None, f"no answer in {TIMEOUT:.0f} s"
    if done.returncode:
        lines = done.stderr.strip().splitlines() or ["no message"]
        return None, f"exit code {done.returncode}: {lines[-1]}"
    try:
        answer: dict[str, Any] = json.loads(
            (given / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8")
        )
    except (OSError, ValueError) as error:
        return None, f"no diagnosis.json: {error}"
    return answer, None

"""One trial: a run with something hidden, and a diagnosis by a process that gets the log alone."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.blind.trials import Trial
from studies.blind.unlisted import UNLISTED
from studies.experiment import simulate

LOG = "samples.parquet"
COMMAND = (sys.executable, "-c", "from studies.cli import main; main()", "diagnose")
"""`realitygap diagnose`, by this interpreter."""
TIMEOUT = 900.0
"""s for one diagnosis; our choice."""


@dataclass(frozen=True)
class Task:
    """A trial and who diagnoses it."""

    trial: Trial
    command: tuple[str, ...] = COMMAND
    """Called with the log's name and `--out`."""


def run_trial(task: Task) -> dict[str, Any]:
    """Record, forget what was hidden, diagnose. Executed by a worker.

    Returns:
        `diagnosis` (None if it failed), `error`, and s of wall time of both parts.
    """
    with tempfile.TemporaryDirectory(prefix="realitygap-") as scratch:
        given = Path(scratch) / "given"
        given.mkdir()
        began = time.perf_counter()
        record(task.trial, Path(scratch) / "run", given / LOG)
        recorded = time.perf_counter()
        diagnosis, error = diagnose(given, task.command, task.trial.withheld)
        return {
            "diagnosis": diagnosis,
            "error": error,
            "record_seconds": round(recorded - began, 3),
            "diagnose_seconds": round(time.perf_counter() - recorded, 3),
        }


def record(trial: Trial, run: Path, log: Path) -> None:
    """Simulate in directory `run`, which is gone before anybody diagnoses `log`."""
    run.mkdir()
    simulate(trial.run, tuple(one.spec for one in trial.hidden), run, unlisted=UNLISTED)
    shutil.move(run / LOG, log)
    shutil.rmtree(run)


def diagnose(
    given: Path, command: tuple[str, ...], withheld: tuple[str, ...] = ()
) -> tuple[dict[str, Any] | None, str | None]:
    """Run a diagnosis of the log in a directory where nothing else is; one thread per library.

    Args:
        given: The directory.
        command: What diagnoses.
        withheld: Causes that it must do without.
    """
    words = [word for name in withheld for word in ("--without", name)]
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    try:
        done = subprocess.run(
            [*command, LOG, "--out", "diagnosis", *words],
            cwd=given,
            env={**os.environ, **threads},
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

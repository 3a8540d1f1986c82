"""Runs what a study has not yet run, on every core, and keeps each run when it is whole."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import closing

from realitygap.studies.paper.conditions import PlannedRun
from realitygap.studies.paper.directory import Run, Session, Study, StudyDirectory
from realitygap.studies.paper.tally import Tally
from realitygap.studies.plumbing.execution import Unfinished, Workers
from realitygap.studies.plumbing.lifetime import shielded
from realitygap.studies.plumbing.machine import Cores
from realitygap.studies.plumbing.manifest import made
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import simulate


class RunsFailed(Unfinished):
    """Some runs raised an error; the others are kept."""


def run_files(run: PlannedRun) -> dict[str, bytes]:
    """Simulate one run; its files by name. Executed by a worker."""
    with scratch() as room:
        simulate(run.config, (), room)
        return {path.name: path.read_bytes() for path in sorted(room.iterdir())}


def execute(
    directory: StudyDirectory[Study, Run],
    workers: Workers,
    work: Callable[[Run], dict[str, bytes]],
    *,
    quiet: bool,
) -> None:
    """Do the runs that are missing and write down what they took.

    Args:
        directory: The study's.
        workers: Where.
        work: Makes a run's files by name.
        quiet: Show nothing.

    Raises:
        RunsFailed: some runs raised; the others are kept.
        WorkersLost: workers keep dying.
        InputError: the scheduler does not answer, or a worker has another program.
    """
    flaws: list[str] = []
    pending = directory.pending(flaws.append)
    if not pending:
        return
    began, cores = time.perf_counter(), Cores()
    spent, hours, kept, side_by_side = 0.0, 0.0, 0, 0
    failures: list[str] = []
    try:
        with (
            Tally(directory.runs, pending, quiet=quiet) as tally,
            closing(made(work, pending, workers, note=tally.say)) as runs,
        ):
            for flaw in flaws:
                tally.say(flaw)
            for done in runs:
                if done.value is None:
                    failures.append(f"{done.task.name}: {done.error}")
                    tally.say(f"run {failures[-1]}")
                    continue
                with shielded():  # what is kept is counted
                    directory.keep(done.task, done.value)
                    kept, side_by_side = kept + 1, done.workers
                    spent += done.cpu_seconds
                    hours += done.task.config.minutes / 60.0
                tally.finished(done.task)
    finally:
        wall = time.perf_counter() - began
        directory.add_session(
            Session(
                runs=kept,
                simulated_hours=round(hours, 4),
                wall_seconds=round(wall, 2),
                workers=side_by_side,
                scheduler=workers.scheduler,
                worker_cpu_seconds=round(spent, 2),
                worker_share=round(spent / (wall * max(side_by_side, 1)), 4),
                cores_busy=cores.busy(),
            )
        )
    if failures:
        raise RunsFailed(f"{len(failures)} runs failed, first {failures[0]}")

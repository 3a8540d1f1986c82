"""Runs what a study has not yet run, on every core; keeps each whole run, shows how far it is."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Self

from rich.progress import MofNCompleteColumn, TextColumn

from realitygap.studies.paper.conditions import PlannedRun
from realitygap.studies.paper.directory import Planned, Run, Session, Study, StudyDirectory
from realitygap.studies.plumbing.execution import Unfinished, Workers
from realitygap.studies.plumbing.lifetime import shielded
from realitygap.studies.plumbing.manifest import made
from realitygap.studies.plumbing.progress import Shown
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import simulate


class Tally(Shown):
    """A context in which `finished` says which run is kept."""

    def __init__(self, runs: Sequence[Planned], pending: Sequence[Planned], *, quiet: bool) -> None:
        self._total, self._done = len(runs), len(runs) - len(pending)
        self._cost_left = sum(run.cost for run in pending)
        self._cost_done = self._minutes = 0.0
        rate = TextColumn("{task.fields[rate]}")
        columns = (MofNCompleteColumn(), rate)
        super().__init__("runs", self._total, columns, quiet=quiet, completed=self._done, rate="")

    def __enter__(self) -> Self:
        super().__enter__()
        if self._done:
            self.say(f"{self._done} of {self._total} runs are there already")
        return self

    def finished(self, run: Planned) -> None:
        """One more run is kept."""
        self._done += 1
        self._minutes += run.config.minutes
        self._cost_done += run.cost
        self._cost_left -= run.cost
        elapsed = max(self._seconds(), 1e-3)
        rate = (
            f"{self._minutes / elapsed:.1f} simulated hours per minute, "
            f"{_clock(elapsed * self._cost_left / self._cost_done)} left"
        )
        if self._change(last=self._done == self._total, completed=self._done, rate=rate):
            self.say(f"{self._done} of {self._total} runs, {rate}")


def _clock(seconds: float) -> str:
    """Minutes and seconds."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"


STAT = Path("/proc/stat")


class Cores:
    """Measures the busy share of every core from its creation on."""

    def __init__(self) -> None:
        self._before = _times()

    def busy(self) -> list[float]:
        """Share of time each core was not idle since then; empty where the kernel does not say."""
        shares = []
        for core, (idle, total) in _times().items():
            was_idle, was_total = self._before.get(core, (idle, total))
            if total > was_total:
                shares.append(round(1.0 - (idle - was_idle) / (total - was_total), 4))
        return shares


def _times() -> dict[str, tuple[int, int]]:
    """Idle and total ticks of every core this process may use."""
    try:
        lines = STAT.read_text(encoding="ascii").splitlines()
    except OSError:
        return {}
    ours = {f"cpu{core}" for core in os.sched_getaffinity(0)}
    times = {}
    for line in lines:
        name, *ticks = line.split()
        if name in ours:
            counts = [int(tick) for tick in ticks[:8]]  # user .. steal; guests are within user
            times[name] = (counts[3] + counts[4], sum(counts))  # idle and waiting for a disk
    return times


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

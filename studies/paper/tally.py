"""What a study shows while it runs: runs done, simulated hours per minute, time left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from rich.progress import MofNCompleteColumn, TextColumn

from realitygap.studies.paper.directory import Planned
from realitygap.studies.plumbing.progress import Shown


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

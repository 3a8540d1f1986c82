"""What a study shows while it runs: runs done, simulated hours per minute, time left."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from studies.paper.directory import Planned

LINE_SECONDS = 15.0
"""s between plain lines where there is no terminal; our choice."""


class Tally:
    """A bar on a terminal, plain lines elsewhere, nothing when quiet."""

    def __init__(self, runs: Sequence[Planned], pending: Sequence[Planned], *, quiet: bool) -> None:
        self._total, self._done = len(runs), len(runs) - len(pending)
        self._cost_left = sum(run.cost for run in pending)
        self._cost_done = self._minutes = 0.0
        self._quiet, self._console = quiet, Console(stderr=True)
        self._began = time.monotonic()
        self._said = self._began
        self._bar: Progress | None = None
        if not quiet and self._console.is_terminal:
            self._bar = Progress(
                TextColumn("runs"),
                BarColumn(),
                MofNCompleteColumn(),
                TextColumn("{task.fields[rate]}"),
                console=self._console,
            )
            self._task = self._bar.add_task(
                "runs", total=self._total, completed=self._done, rate=""
            )

    def __enter__(self) -> Tally:
        if self._bar is not None:
            self._bar.start()
        if self._done:
            self.say(f"{self._done} of {self._total} runs are there already")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def finished(self, run: Planned) -> None:
        """One more run is kept."""
        self._done += 1
        self._minutes += run.config.minutes
        self._cost_done += run.cost
        self._cost_left -= run.cost
        now = time.monotonic()
        elapsed = max(now - self._began, 1e-3)
        rate = (
            f"{self._minutes / elapsed:.1f} simulated hours per minute, "
            f"{_clock(elapsed * self._cost_left / self._cost_done)} left"
        )
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, rate=rate)
        elif self._done == self._total or now - self._said >= LINE_SECONDS:
            self._said = now
            self.say(f"{self._done} of {self._total} runs, {rate}")

    def say(self, text: str) -> None:
        """A line for the person watching."""
        if not self._quiet:
            self._console.print(text, highlight=False, soft_wrap=True, markup=False)


def _clock(seconds: float) -> str:
    """Minutes and seconds."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"

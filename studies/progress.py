"""How far a command has come: a bar with time left on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

LINE_SECONDS = 15.0
"""s between plain lines where there is no terminal."""


class Progress:
    """A context in which `reach` says how much of `total` is done."""

    def __init__(self, what: str, total: float, quiet: bool) -> None:
        self._what, self._total, self._quiet = what, total, quiet
        self._console = Console(stderr=True)
        self._began = self._said = time.monotonic()
        self._bar: Bar | None = None
        if not quiet and self._console.is_terminal:
            self._bar = Bar(
                TextColumn("{task.description}"),
                BarColumn(),
                TaskProgressColumn(),
                TimeRemainingColumn(),
                console=self._console,
            )
            self._task = self._bar.add_task(what, total=total)

    def __enter__(self) -> Progress:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def reach(self, done: float) -> None:
        """So much of the total is done."""
        if self._bar is not None:
            self._bar.update(self._task, completed=done)
            return
        now = time.monotonic()
        if not self._quiet and now - self._said >= LINE_SECONDS and done > 0:
            self._said = now
            left = (now - self._began) * (self._total - done) / done
            self.say(f"{self._what}: {100.0 * done / self._total:.0f} %, about {left:.0f} s left")

    def say(self, text: str) -> None:
        """A line for the person watching."""
        self._console.print(text, highlight=False, soft_wrap=True, markup=False)

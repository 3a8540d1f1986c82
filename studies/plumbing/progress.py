"""How far a command has come: a bar with time left on a terminal, plain lines elsewhere."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    ProgressColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.progress import Progress as Bar

from realitygap.embedded_sim.errors import shown

LINE_SECONDS = 15.0
"""s between plain lines where there is no terminal; our choice."""


LONGEST_LINE = 2000
"""Letters of a line; what it quotes may be of any length."""


class Shown:
    """A context that shows how far something is; nothing when quiet."""

    def __init__(
        self,
        what: str,
        total: float | None,
        columns: Sequence[ProgressColumn],
        *,
        quiet: bool,
        transient: bool = False,
        **fields: Any,
    ) -> None:
        self._quiet, self._console = quiet, Console(stderr=True)
        self._began = self._said = time.monotonic()
        self._bar: Bar | None = None
        if not quiet and self._console.is_terminal:
            every = (TextColumn("{task.description}", markup=False), BarColumn(), *columns)
            self._bar = Bar(*every, console=self._console, transient=transient)
            self._task = self._bar.add_task(what, total=total, **fields)

    def __enter__(self) -> Self:
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

    def say(self, text: str) -> None:
        """A line for the person watching."""
        if not self._quiet:
            line = shown(text, LONGEST_LINE)
            self._console.print(line, highlight=False, soft_wrap=True, markup=False)

    def _change(self, *, last: bool = False, **changed: Any) -> bool:
        """Change the bar; without one, whether it is time for a line, as it is for the last."""
        if self._bar is not None:
            self._bar.update(self._task, **changed)
            return False
        if not last and time.monotonic() - self._said < LINE_SECONDS:
            return False
        self._said = time.monotonic()
        return True

    def _seconds(self) -> float:
        """s since it began."""
        return time.monotonic() - self._began


class Progress(Shown):
    """A context in which `reach` says how much of `total` is done."""

    def __init__(self, what: str, total: float, quiet: bool) -> None:
        super().__init__(what, total, (TaskProgressColumn(), TimeRemainingColumn()), quiet=quiet)
        self._what, self._total = what, total

    def reach(self, done: float) -> None:
        """So much of the total is done."""
        if self._change(completed=done) and done > 0:
            left = self._seconds() * (self._total - done) / done
            self.say(f"{self._what}: {100.0 * done / self._total:.0f} %, about {left:.0f} s left")


class Stages(Shown):
    """A context in which `begin` names what is done now; on a terminal alone, gone when done."""

    def __init__(self, what: str, quiet: bool) -> None:
        super().__init__(what, None, (TimeElapsedColumn(),), quiet=quiet, transient=True)
        self._what = what

    def begin(self, stage: str) -> None:
        """This is done from now on."""
        logging.getLogger("realitygap").info("%s: %s", self._what, shown(stage))
        self._change(description=shown(f"{self._what}: {stage}"))


def unseen(stage: str) -> None:
    """In place of `Stages.begin` where nobody watches."""

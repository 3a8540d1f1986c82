"""A battery's directory: what was asked, and one piece per finished trial.

battery.json             configuration without the number of trials, and versions
trials/NNNNN/trial.json  what was hidden, what the diagnosis answered; its manifest beside it
blind.json, figures/, report.html   made from the trials

What a battery lacks is done: each trial by a worker, and kept as it ends.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import BaseModel

from realitygap.studies.blind.record import Diagnosed, Task
from realitygap.studies.blind.trials import Trial
from realitygap.studies.plumbing.execution import Unfinished, Workers
from realitygap.studies.plumbing.manifest import Pieces, made
from realitygap.studies.plumbing.progress import Progress
from realitygap.studies.plumbing.provenance import as_json_bytes
from realitygap.studies.plumbing.resumed import resumed

TRIAL = "trial.json"
Config = TypeVar("Config", bound=BaseModel)


class BlindDirectory(Generic[Config]):
    """The directory, held by one process at a time."""

    def __init__(self, out: Path, config: Config, trials: Sequence[Trial]) -> None:
        self.out, self.config, self.trials = out, config, trials
        self._pieces = Pieces(out / "trials", "trial")

    @contextmanager
    def held(self) -> Iterator[BlindDirectory[Config]]:
        """Make or resume the directory.

        Raises:
            InputError: it belongs to another battery or program, to something else, or is in use;
                or what says so is damaged.
        """
        asked = self.config.model_dump(mode="json", exclude={"trials"})  # more may be asked for
        with resumed(self.out, "battery.json", "trials", "a battery", asked):
            yield self

    def pending(self, note: Callable[[str], None] = lambda line: None) -> list[Trial]:
        """Trials that are not whole, longest first; what is there in their place is removed.

        Args:
            note: Told in a line of each trial that is made anew, and why.
        """
        wanted = {trial.name: trial.made_from for trial in self.trials}
        missing = set(self._pieces.missing(wanted, note))
        left = [trial for trial in self.trials if trial.name in missing]
        return sorted(left, key=lambda trial: -trial.seconds)

    def keep(self, trial: Trial, answer: dict[str, Any]) -> None:
        """Write a finished trial."""
        content = as_json_bytes({"schema": 1, **trial.notes(), **answer})
        self._pieces.keep(trial.name, trial.made_from, {TRIAL: content})

    def answers(self) -> list[tuple[Trial, dict[str, Any]]]:
        """All trials, once none is pending, and their answers."""
        return [
            (trial, json.loads((self._pieces.path(trial.name) / TRIAL).read_bytes()))
            for trial in self.trials
        ]


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

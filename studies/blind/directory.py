"""A battery's directory: what was asked, and one file per finished trial.

battery.json        configuration without the number of trials, and versions
trials/NNNNN.json   what was hidden, what the diagnosis answered
blind.json, figures/, report.html   made from the trials
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from embedded_sim.errors import InputError
from studies.blind.trials import BlindConfig, Trial
from studies.output import whole_file
from studies.provenance import versions, write_json
from studies.resumed import check_same, locked

OURS = ("battery.json", "trials", "figures", "blind.json", "report.html", ".lock")


class BlindDirectory:
    """The directory, held by one process at a time."""

    def __init__(self, out: Path, config: BlindConfig, trials: tuple[Trial, ...]) -> None:
        self.out, self.config, self.trials = out, config, trials

    @contextmanager
    def held(self) -> Iterator[BlindDirectory]:
        """Make or resume the directory.

        Raises:
            InputError: it belongs to another battery, to something else, or is in use.
        """
        if self.out.exists() and not self.out.is_dir():
            raise InputError("--out", self.out, "a directory")
        if self.out.is_dir() and not (self.out / "battery.json").exists():
            strangers = [path for path in self.out.iterdir() if path.name not in OURS]
            if strangers:
                raise InputError("--out", self.out, "a new or empty directory, or a battery")
        with locked(self.out, "trials", "a battery"):
            self._resume()
            yield self

    def pending(self) -> list[Trial]:
        """Trials that are not there, longest first."""
        left = [trial for trial in self.trials if not self._path(trial).exists()]
        return sorted(left, key=lambda trial: -trial.seconds)

    def keep(self, trial: Trial, answer: dict[str, Any]) -> None:
        """Write a finished trial."""
        with whole_file(self._path(trial), force=True) as part:
            write_json(part, {"schema": 1, **trial.notes(), **answer})

    def answers(self) -> list[tuple[Trial, dict[str, Any]]]:
        """The trials that are there, and their answers."""
        return [
            (trial, json.loads(self._path(trial).read_text(encoding="utf-8")))
            for trial in self.trials
            if self._path(trial).exists()
        ]

    def _path(self, trial: Trial) -> Path:
        return self.out / "trials" / f"{trial.name}.json"

    def _resume(self) -> None:
        """More trials may be asked for than before, nothing else may differ."""
        asked = {**self.config.model_dump(mode="json", exclude={"trials"}), **versions()}
        path = self.out / "battery.json"
        if not path.exists():
            with whole_file(path) as part:
                write_json(part, asked)
            return
        try:
            found = dict(json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            raise InputError("--out", path, "the battery.json of a battery") from None
        check_same(self.out, found, asked)

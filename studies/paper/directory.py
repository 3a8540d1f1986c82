"""A study's directory: what was asked, the runs that are finished, and who is writing.

study.json          configuration, versions, every run's seed, the sessions that computed it
runs/NAME/          one run each, named when it is whole
*.parquet, figures/, report.html   made from the runs
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from pydantic import BaseModel

from embedded_sim.errors import InputError
from studies.experiment import RunConfig
from studies.output import whole_directory, whole_file
from studies.provenance import versions, write_json
from studies.resumed import check_same, locked

SCHEMA = 1
RUN_FILES = ("run.json", "truth.json", "generations.parquet", "deposits.parquet")


class Planned(Protocol):
    """A run of a study."""

    @property
    def name(self) -> str:
        """Of its directory."""

    @property
    def config(self) -> RunConfig:
        """What is run."""

    @property
    def cost(self) -> float:
        """Expected computing time in any unit."""


Study = TypeVar("Study", bound=BaseModel)
Run = TypeVar("Run", bound=Planned)


class StudyDirectory(Generic[Study, Run]):
    """The directory, held by one process at a time."""

    def __init__(self, out: Path, study: Study, runs: tuple[Run, ...]) -> None:
        self.out, self.study, self.runs = out, study, runs
        self._notes: dict[str, Any] = {
            "schema": SCHEMA,
            "configuration": study.model_dump(mode="json"),
            "versions": versions(),
            "seeds": {run.name: run.config.seed for run in runs},
            "sessions": [],
        }

    @contextmanager
    def held(self) -> Iterator[StudyDirectory[Study, Run]]:
        """Make or resume the directory and keep other studies out of it.

        Raises:
            InputError: it belongs to another configuration, to something else, or is in use.
        """
        self._refuse_strangers()
        with locked(self.out, "runs", "a study"):
            self._resume()
            yield self

    def path(self, run: Run) -> Path:
        """Where a run's files are."""
        return self.out / "runs" / run.name

    def pending(self) -> list[Run]:
        """Runs that are not whole, longest first; remains of killed ones are removed."""
        for remains in (self.out / "runs").glob(".*"):
            shutil.rmtree(remains, ignore_errors=True)
        left = []
        for run in self.runs:
            path = self.path(run)
            if not all((path / name).is_file() for name in RUN_FILES):
                shutil.rmtree(path, ignore_errors=True)
                left.append(run)
        return sorted(left, key=lambda run: -run.cost)

    def keep(self, run: Run, files: dict[str, bytes]) -> None:
        """Write a finished run; its directory appears when it is whole."""
        with whole_directory(self.path(run)) as part:
            for name, content in files.items():
                (part / name).write_bytes(content)

    @property
    def sessions(self) -> list[dict[str, Any]]:
        """What each call that computed runs took."""
        return list(self._notes["sessions"])

    def add_session(self, session: dict[str, Any]) -> None:
        """Remember what computing took."""
        self._notes["sessions"].append(session)
        self._write()

    @property
    def notes(self) -> dict[str, Any]:
        """The content of `study.json`."""
        return dict(self._notes)

    def _refuse_strangers(self) -> None:
        if self.out.exists() and not self.out.is_dir():
            raise InputError("--out", self.out, "a directory")
        if (
            self.out.is_dir()
            and not (self.out / "study.json").exists()
            and any(path.name not in (".lock", "runs") for path in self.out.iterdir())
        ):
            raise InputError("--out", self.out, "a new or empty directory, or a study to resume")
        parent = next(p for p in self.out.absolute().parents if p.exists())
        if not os.access(parent, os.W_OK | os.X_OK):
            raise InputError("--out", self.out, f"a writable directory ({parent} is not)")

    def _resume(self) -> None:
        path = self.out / "study.json"
        if not path.exists():
            self._write()
            return
        try:
            there = json.loads(path.read_text(encoding="utf-8"))
            found = {**there["configuration"], **there["versions"]}
            sessions = list(there["sessions"])
        except (OSError, ValueError, KeyError, TypeError):
            raise InputError("--out", path, "the study.json of a study") from None
        asked = {**self._notes["configuration"], **self._notes["versions"]}
        check_same(self.out, found, asked)
        self._notes["sessions"] = sessions

    def _write(self) -> None:
        with whole_file(self.out / "study.json", force=True) as part:
            write_json(part, self._notes)

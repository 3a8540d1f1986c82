"""A study's directory: what was asked, the runs that are finished, and who is writing.

study.json          configuration, versions, every run's seed, the sessions that computed it
runs/NAME/          one run each, with its manifest, named when it is whole
*.parquet, figures/, report.html   made from the runs
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.plumbing.manifest import Origin, Pieces
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.provenance import versions, write_json
from realitygap.studies.plumbing.resumed import begun_with, check_ours, check_same, locked
from realitygap.studies.run.experiment import RunConfig


class Planned(Protocol):
    """A run of a study."""

    @property
    def name(self) -> str:
        """Of its directory."""

    @property
    def config(self) -> RunConfig:
        """What is run."""

    @property
    def made_from(self) -> Origin:
        """All that its files are a function of but the program."""

    @property
    def cost(self) -> float:
        """Expected computing time in any unit."""


Study = TypeVar("Study", bound=BaseModel)
Run = TypeVar("Run", bound=Planned)


class Session(BaseModel):
    """What one call that computed runs took."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    runs: int
    simulated_hours: float
    wall_seconds: float
    workers: int
    scheduler: str | None
    worker_cpu_seconds: float
    worker_share: float
    """Of the wall time that the workers were computing."""
    cores_busy: list[float]


class Notes(BaseModel):
    """The content of `study.json`."""

    model_config = ConfigDict(extra="forbid")

    version: Literal[1] = Field(default=1, alias="schema")
    configuration: dict[str, Any]
    versions: dict[str, str]
    seeds: dict[str, int]
    sessions: list[Session] = []


class StudyDirectory(Generic[Study, Run]):
    """The directory, held by one process at a time."""

    def __init__(self, out: Path, study: Study, runs: tuple[Run, ...]) -> None:
        self.out, self.study, self.runs = out, study, runs
        self._pieces = Pieces(out / "runs", "run")
        self._notes = Notes(
            configuration=study.model_dump(mode="json"),
            versions=versions(),
            seeds={run.name: run.config.seed for run in runs},
        )

    @contextmanager
    def held(self) -> Iterator[StudyDirectory[Study, Run]]:
        """Make or resume the directory and keep other studies out of it.

        Raises:
            InputError: it belongs to another configuration or program, to something else, or is in
                use; or what says so is damaged.
        """
        check_ours(self.out, "study.json", "runs", "a study")
        parent = next(p for p in self.out.absolute().parents if p.exists())
        if not os.access(parent, os.W_OK | os.X_OK):
            raise InputError("--out", self.out, f"a writable directory ({parent} is not)")
        with locked(self.out, "runs", "a study"):
            self._resume()
            yield self

    def widen(self, runs: tuple[Run, ...]) -> None:
        """From now on it is a directory of these runs; none that is finished is lost."""
        self.runs = runs
        self._notes.seeds = {run.name: run.config.seed for run in runs}
        self._write()

    def path(self, run: Run) -> Path:
        """Where a run's files are."""
        return self._pieces.path(run.name)

    def pending(self, note: Callable[[str], None] = lambda line: None) -> list[Run]:
        """Runs that are not whole, longest first; remains and what is no run of it are removed.

        Args:
            note: Told in a line of each run that is made anew, and why.
        """
        wanted = {run.name: run.made_from for run in self.runs}
        missing = set(self._pieces.missing(wanted, note))
        return sorted((run for run in self.runs if run.name in missing), key=lambda run: -run.cost)

    def keep(self, run: Run, files: dict[str, bytes]) -> None:
        """Write a finished run; its directory appears when it is whole."""
        self._pieces.keep(run.name, run.made_from, files)

    @property
    def sessions(self) -> list[dict[str, Any]]:
        """What each call that computed runs took."""
        return [session.model_dump() for session in self._notes.sessions]

    def add_session(self, session: Session) -> None:
        """Remember what computing took."""
        self._notes.sessions.append(session)
        self._write()

    @property
    def notes(self) -> dict[str, Any]:
        """The content of `study.json`."""
        return self._notes.model_dump(by_alias=True)

    def _resume(self) -> None:
        path = self.out / "study.json"
        if not path.exists():
            self._write()
            return
        there, asked = begun_with(path, Notes, "a study"), self._notes
        check_same(
            self.out,
            {**there.configuration, **there.versions},
            {**asked.configuration, **asked.versions},
        )
        self._notes.sessions = there.sessions

    def _write(self) -> None:
        with whole_file(self.out / "study.json", force=True) as part:
            write_json(part, self.notes)

"""Pieces of a study that are made once and used again only if they are what they should be.

A piece (a run, a trial, a group, a model) is a directory of files with a manifest: what they are a
function of, the program that made them, and the SHA-256 of each. A piece that is another's, empty,
cut short, changed or of another program is made anew, and it is said why.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Literal, TypeAlias, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.plumbing.execution import Finished, Workers, completed
from realitygap.studies.plumbing.output import SUFFIX, whole_directory
from realitygap.studies.plumbing.provenance import as_json_bytes, file_sha256, versions
from realitygap.studies.plumbing.rooms import clear_stale

MANIFEST = "manifest.json"
SHOWN = 40
"""Characters of a value that a line shows; our choice."""

Origin: TypeAlias = Mapping[str, Any]
"""All that a piece is a function of but the program, as JSON has it."""
Task = TypeVar("Task")
Result = TypeVar("Result")


class Manifest(BaseModel):
    """The content of `manifest.json`."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    version: Literal[1] = Field(default=1, alias="schema")
    made_from: dict[str, Any]
    versions: dict[str, str]
    files: dict[str, str]
    """SHA-256 by name; there are no others."""


@dataclass(frozen=True)
class Pieces:
    """The pieces in one folder of a directory that is held."""

    folder: Path
    kind: str
    """What a piece is, in a word."""

    def path(self, name: str) -> Path:
        """Where a piece's files are."""
        return self.folder / name

    def missing(
        self, wanted: Mapping[str, Origin], note: Callable[[str], None] = lambda line: None
    ) -> list[str]:
        """Names of the pieces to make; remains of killed commands, and pieces that cannot be used,
        are removed.

        Args:
            wanted: What every piece must be made from.
            note: Told in a line of every piece that is made anew, and why.

        Raises:
            InputError: what cannot be used cannot be removed.
        """
        if self.folder.is_dir():
            clear_stale(self.folder, ".", SUFFIX)
        names = []
        for name, origin in wanted.items():
            path = self.path(name)
            there = path.exists() or path.is_symlink()
            flaw = _flaw(path, origin) if there else None
            if flaw is not None:
                _remove(path)
                note(f"{self.kind} {name} is made anew: {flaw}")
            if not there or flaw is not None:
                names.append(name)
        return names

    def keep(self, name: str, origin: Origin, files: Mapping[str, bytes]) -> None:
        """Write a finished piece; its directory appears when it is whole."""
        with whole_directory(self.path(name)) as part:
            for file, content in files.items():
                (part / file).write_bytes(content)
            manifest = Manifest(
                made_from=_plain(origin),
                versions=versions(),
                files={file: file_sha256(part / file) for file in sorted(files)},
            )
            (part / MANIFEST).write_bytes(as_json_bytes(manifest.model_dump(by_alias=True)))

    def files(self, name: str) -> dict[str, bytes]:
        """A whole piece's files by name, without the manifest."""
        return {
            path.name: path.read_bytes()
            for path in sorted(self.path(name).iterdir())
            if path.name != MANIFEST
        }


def _flaw(path: Path, origin: Origin) -> str | None:
    """Why a piece cannot be used; None: it can."""
    if not (path / MANIFEST).is_file():  # nor a pipe, which would keep its reader waiting
        return f"it has no {MANIFEST}"
    try:
        noted = Manifest.model_validate_json((path / MANIFEST).read_bytes())
        there = {file.name for file in path.iterdir()} - {MANIFEST}
    except (OSError, ValidationError):
        return f"its {MANIFEST} cannot be read"
    if differs := _difference(noted.made_from, _plain(origin)):
        return f"it is another's, with {differs}"
    if differs := _difference(noted.versions, versions()):
        return f"another program made it, with {differs}"
    for name, digest in noted.files.items():
        if name not in there:
            return f"its {_short(name)} is missing"
        if not _holds(path / name, digest):
            return f"its {_short(name)} is not as it was written"
    strange = there - set(noted.files)
    return f"{_short(min(strange))} is not of it" if strange else None


def _holds(path: Path, digest: str) -> bool:
    try:
        return path.is_file() and file_sha256(path) == digest
    except OSError:
        return False


def _plain(origin: Origin) -> dict[str, Any]:
    """As it comes back from JSON."""
    plain: dict[str, Any] = json.loads(json.dumps(origin, allow_nan=False))
    return plain


def _difference(there: Any, now: Any, at: str = "") -> str | None:
    """The first value that differs, in words."""
    if isinstance(there, dict) and isinstance(now, dict):
        for key in {**now, **there}:
            name = _short(key)
            found = _difference(there.get(key), now.get(key), f"{at}.{name}" if at else name)
            if found:
                return found
        return None
    if there == now:
        return None
    return f"{at} {_short(there)}, not {_short(now)}"


def _short(value: Any) -> str:
    """A value that may come from outside, on a line and of no great length."""
    text = value if isinstance(value, str) and value.isprintable() else json.dumps(value)
    return text if len(text) <= SHOWN else text[:SHOWN] + "..."


def _remove(path: Path) -> None:
    try:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
    except OSError as error:
        raise InputError("--out", path, f"what can be replaced ({error.strerror})") from None


@dataclass(frozen=True)
class _Signed(Generic[Task, Result]):
    """Work whose result says by which program it was done."""

    work: Callable[[Task], Result]

    def __call__(self, task: Task) -> tuple[dict[str, str], Result]:
        return versions(), self.work(task)


def made(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    workers: Workers,
    *,
    note: Callable[[str], None] = lambda text: None,
) -> Generator[Finished[Task, Result], None, None]:
    """As `completed`, by workers that have this very program: others' results are not taken.

    Raises:
        WorkersLost: workers keep dying.
        InputError: the scheduler does not answer, or a worker has another program.
    """
    with closing(completed(_Signed(work), tasks, workers, note=note)) as finished:
        for one in finished:
            program, value = (versions(), None) if one.value is None else one.value
            if differs := _difference(program, versions()):
                got = f"a worker with {differs}"
                expected = "this very program, which does not change while it works"
                raise InputError(workers.scheduler or "program", got, expected)
            yield Finished(one.task, value, one.error, one.cpu_seconds, one.workers)

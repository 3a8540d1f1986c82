"""Directories that are resumed: held by one process at a time, for what they were begun with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.plumbing.output import SUFFIX, claimed, whole_file
from realitygap.studies.plumbing.provenance import versions, write_json

Shape = TypeVar("Shape")


@contextmanager
def resumed(
    out: Path, notes: str, folder: str, kind: str, asked: Mapping[str, Any]
) -> Iterator[None]:
    """Make or resume a directory that is begun with what was asked, by this very program.

    Args:
        out: The directory; may be there.
        notes: The file in it that says what it was begun with.
        folder: Of its pieces.
        kind: What the directory is of, as in "a study".
        asked: What it is, as JSON has it.

    Raises:
        InputError: it belongs to another configuration or program, to something else, or is in use;
            or what says so is damaged.
    """
    begun, path = {**asked, **versions()}, out / notes
    check_ours(out, notes, folder, kind)
    with locked(out, folder, kind):
        if path.exists():
            check_same(out, begun_with(path, dict[str, Any], kind), begun)
        else:
            with whole_file(path) as part:
                write_json(part, begun)
        yield


@contextmanager
def locked(out: Path, folder: str, kind: str) -> Iterator[None]:
    """Make a directory with a folder in it and keep other processes out of it.

    Args:
        out: The directory; may be there.
        folder: In it; may be there.
        kind: What the directory is of, as in "a study".

    Raises:
        InputError: it cannot be written, or another process writes to it.
    """
    with claimed(out, kind):
        try:
            (out / folder).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError("--out", out, f"a writable directory ({error.strerror})") from None
        yield


def check_same(out: Path, there: Mapping[str, Any], asked: Mapping[str, Any]) -> None:
    """Refuse to go on with something else than what was begun.

    Raises:
        InputError: says what differs.
    """
    differs = [
        f"{key} {there.get(key)} there, {asked.get(key)} now"
        for key in {**asked, **there}
        if there.get(key) != asked.get(key)
    ]
    if differs:
        expected = "the configuration and program it was begun with; differs: " + "; ".join(differs)
        raise InputError("--out", out, expected)


def check_ours(out: Path, notes: str, folder: str, kind: str) -> None:
    """Refuse a directory with anything in it that was not begun by this program.

    Args:
        out: The directory; may be there.
        notes: The file in it that says what it was begun with.
        folder: Of its pieces.
        kind: What the directory is of, as in "a study".

    Raises:
        InputError: `out` is no directory, or holds something else.
    """
    if out.exists() and not out.is_dir():
        raise InputError("--out", out, "a directory")
    if not out.is_dir() or (out / notes).exists():
        return
    ours = (folder, f".{notes}{SUFFIX}")
    strange = [path for path in out.iterdir() if path.name not in ours]
    if strange or any((out / folder).glob("*")):
        raise InputError("--out", out, f"a new or empty directory, or {kind} to resume")


def begun_with(path: Path, shape: type[Shape], kind: str) -> Shape:
    """What a directory was begun with, out of the JSON that says so.

    Raises:
        InputError: the file is damaged.
    """
    expected = f"the {path.name} of {kind}; it is damaged: restore it, or use another directory"
    if not path.is_file():  # nor a pipe, which would keep its reader waiting
        raise InputError("--out", path, expected)
    try:
        return TypeAdapter(shape).validate_json(path.read_bytes(), strict=True)
    except (OSError, ValidationError):
        raise InputError("--out", path, expected) from None

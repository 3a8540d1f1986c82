"""Directories that are resumed: held by one process at a time, for what they were begun with."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from embedded_sim.errors import InputError


@contextmanager
def locked(out: Path, folder: str, kind: str) -> Iterator[None]:
    """Make a directory with a folder in it and keep other processes out of it.

    Args:
        out: The directory; may be there.
        folder: In it; may be there.
        kind: What the directory is of, as in "a study".

    Raises:
        InputError: it cannot be written, or is in use.
    """
    try:
        (out / folder).mkdir(parents=True, exist_ok=True)
        lock = (out / ".lock").open("a")
    except OSError as error:
        raise InputError("--out", out, f"a writable directory ({error.strerror})") from None
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError("--out", out, f"{kind} that is not running") from None
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
        expected = "the configuration it was begun with; differs: " + "; ".join(differs)
        raise InputError("--out", out, expected)

"""Output that is whole or absent: written under a temporary name, renamed when finished."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from embedded_sim.errors import InputError

OUTPUTS = ("run.json", "gap.json", "diagnosis.json", "gain.json", "study.json", "blind.json")
"""A directory that `--force` may replace holds one of these, or nothing."""


def check_free(out: Path, *, force: bool, holds: tuple[str, ...] = OUTPUTS) -> None:
    """Refuse an existing or unwritable output before any work is done.

    Args:
        out: Where the output goes.
        force: Whether what is there may be replaced.
        holds: A directory is replaced only if it holds one of these files: nobody's thesis, and
            not the log that is being read.

    Raises:
        InputError: `out` exists and may not be replaced, or its parent cannot be written.
    """
    try:
        if out.exists() and not force:
            raise InputError("--out", out, "a path that does not exist yet (or --force)")
        if out.is_dir():
            _check_replaceable(out, holds)
        parent = out.absolute().parent
        existing = next(p for p in (parent, *parent.parents) if p.exists())
    except OSError as error:
        raise InputError("--out", out, f"a path that can be made ({error.strerror})") from None
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InputError("--out", out, f"a path in a writable directory ({existing} is not)")


def _check_replaceable(out: Path, holds: tuple[str, ...]) -> None:
    if Path.cwd().is_relative_to(out.resolve()):
        raise InputError("--out", out, "a directory one is not in")
    names = {path.name for path in out.iterdir()}
    if names and not names & set(holds):
        raise InputError("--out", out, f"a directory to replace that holds {' or '.join(holds)}")


@contextmanager
def _beside(out: Path) -> Iterator[Path]:
    """A hidden directory beside `out`, gone afterwards: what is in it can be renamed at once."""
    parent = out.absolute().parent
    try:
        parent.mkdir(parents=True, exist_ok=True)
        scratch = Path(tempfile.mkdtemp(prefix=f".{out.name[:100]}.part-", dir=parent))
    except OSError as error:
        expected = f"a path in a writable directory ({error.strerror})"
        raise InputError("--out", out, expected) from None
    try:
        yield scratch
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _settle(path: Path) -> None:
    """Have a file, or a directory and the files in it, on the disk before its name says so."""
    for part in [*path.iterdir(), path] if path.is_dir() else [path]:
        handle = os.open(part, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def whole_directory(
    out: Path, *, force: bool = False, holds: tuple[str, ...] = OUTPUTS
) -> Iterator[Path]:
    """A temporary directory that becomes `out` if the block ends well, and vanishes if not.

    It lies in a hidden directory beside `out`, so that renaming is atomic. A killed process leaves
    only that one behind. What `force` may replace: see `check_free`.
    """
    check_free(out, force=force, holds=holds)
    with _beside(out) as scratch:
        part = scratch / "new"
        part.mkdir()
        yield part
        _settle(part)
        if out.exists():
            out.replace(scratch / "old")
        part.replace(out)


@contextmanager
def whole_file(out: Path, *, force: bool = False) -> Iterator[Path]:
    """The same for one file; the block writes to the path it is given."""
    if out.is_dir():
        raise InputError("--out", out, "a file, not a directory")
    check_free(out, force=force)
    with _beside(out) as scratch:
        part = scratch / out.name
        yield part
        _settle(part)
        part.replace(out)

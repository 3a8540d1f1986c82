"""Output that is whole or absent: written under a temporary name, renamed when finished."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from embedded_sim.errors import InputError


def check_free(out: Path, *, force: bool) -> None:
    """Refuse an existing or unwritable output before any work is done.

    Raises:
        InputError: `out` exists and `force` is false, or its parent cannot be written.
    """
    if out.exists() and not force:
        raise InputError("--out", out, "a path that does not exist yet (or --force)")
    parent = out.absolute().parent
    existing = next(p for p in (parent, *parent.parents) if p.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InputError("--out", out, f"a path in a writable directory ({existing} is not)")


def _parent(out: Path) -> Path:
    """The directory an output goes into, made if it can be."""
    parent = out.absolute().parent
    try:
        parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        expected = f"a path in a writable directory ({error.strerror})"
        raise InputError("--out", out, expected) from None
    return parent


@contextmanager
def whole_directory(out: Path, *, force: bool = False) -> Iterator[Path]:
    """A temporary directory that becomes `out` if the block ends well, and vanishes if not.

    The temporary name starts with a dot and lies beside `out`, so that renaming is atomic. A killed
    process leaves only that name behind.
    """
    check_free(out, force=force)
    part = Path(tempfile.mkdtemp(prefix=f".{out.name}.part-", dir=_parent(out)))
    try:
        part.chmod(0o755)
        yield part
        if out.exists():
            old = Path(tempfile.mkdtemp(prefix=f".{out.name}.old-", dir=out.absolute().parent))
            out.replace(old / "was")
            part.replace(out)
            shutil.rmtree(old)
        else:
            part.replace(out)
    finally:
        shutil.rmtree(part, ignore_errors=True)


@contextmanager
def whole_file(out: Path, *, force: bool = False) -> Iterator[Path]:
    """The same for one file; the block writes to the path it is given."""
    check_free(out, force=force)
    if out.is_dir():
        raise InputError("--out", out, "a file, not a directory")
    handle, name = tempfile.mkstemp(
        prefix=f".{out.stem}.part-", suffix=out.suffix, dir=_parent(out)
    )
    os.close(handle)
    part = Path(name)
    try:
        part.chmod(0o644)
        yield part
        part.replace(out)
    finally:
        part.unlink(missing_ok=True)

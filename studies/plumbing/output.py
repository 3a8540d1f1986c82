"""Output that is whole or absent, and never in the place of what was not checked.

Whatever is written is claimed when work begins: a room beside the target, whose lock says who holds
it, is where the work is written. When it is finished, it is renamed in one step.
"""

from __future__ import annotations

import errno
import hashlib
import itertools
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from realitygap.embedded_sim.errors import InputError
from realitygap.studies.plumbing.lifetime import shielded
from realitygap.studies.plumbing.renames import exchange, place
from realitygap.studies.plumbing.rooms import Room, Taken, clear_stale, take

SUFFIX = ".part"
"""Of a room beside a target; its name begins with a dot."""
LONGEST_NAME = 240
"""Bytes of a target's name that a room's name can hold beside its own; file systems allow 255."""
MACHINE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EMFILE, errno.ENFILE)
"""What is the machine's state rather than a bad path."""

Seen = dict[str, tuple[int, ...]]
"""What was there: per path its inode, and for files size (bytes) and time of change (ns)."""
Ours = Callable[[Path], bool]


def readable(read: Callable[[Path], object]) -> Ours:
    """For `ours`: a file that a reader takes, one that raises `InputError` where it does not."""

    def ours(path: Path) -> bool:
        try:
            read(path)
        except InputError:
            return False
        return True

    return ours


@contextmanager
def claimed(out: Path, kind: str = "a path") -> Iterator[Room]:
    """Keep other processes from writing to `out` within the block, whether it is there or not.

    Args:
        out: Where the output goes.
        kind: What it is, for the message.

    Raises:
        InputError: another process writes to it, or its parent cannot be written.
    """
    made: list[Path] = []
    try:
        with _refusing(out, kind):
            target = _real(out)
            made += _make_parents(target.parent)
            room = take(_room_of(target))
        try:
            clear_stale(room.path.parent, ".", SUFFIX)
            yield room
        finally:
            room.close()
    finally:
        with suppress(OSError):  # no longer empty: that is what they were made for
            for folder in made:
                folder.rmdir()


@contextmanager
def whole_directory(
    out: Path, *, force: bool = False, holds: tuple[str, ...] = ()
) -> Iterator[Path]:
    """A temporary directory that becomes `out` if the block ends well, and vanishes if not.

    `out` is claimed within the block: put all work into it. If something has come into its place
    meanwhile, the result is kept beside it.

    Args:
        out: Where the directory goes.
        force: Whether a directory that is there may be replaced.
        holds: Such a directory must be empty or hold one of these files: it is nobody's thesis,
            and not the log that is being read.

    Raises:
        InputError: `out` cannot be claimed, may not be replaced, or is no longer as it was.
    """
    with _refusing(out):
        if out.is_file():
            raise InputError("--out", out, "a directory, not a file")
    with _whole(out, force, holds, None) as (part, commit):
        part.mkdir()
        yield part
        commit()


@contextmanager
def whole_file(
    out: Path, *, force: bool = False, ours: Ours | None = None, needed: bool = True
) -> Iterator[Path]:
    """The same for one file; the block writes to the path it is given.

    Args:
        out: Where the file goes.
        force: Whether a file that is there may be replaced.
        ours: Says of such a file whether a command wrote it; None: any is replaced.
        needed: Otherwise the block may as well write nothing.
    """
    with _refusing(out):
        if out.is_dir():
            raise InputError("--out", out, "a file, not a directory")
    with _whole(out, force, (), ours) as (part, commit):
        yield part
        if needed or part.exists():
            commit()


@contextmanager
def _whole(
    out: Path, force: bool, holds: tuple[str, ...], ours: Ours | None
) -> Iterator[tuple[Path, Callable[[], None]]]:
    """Where to write, and what puts it into its place."""
    with claimed(out) as room:
        with _refusing(out):
            target = _real(out)
            seen = _checked(out, force, holds, ours)
        folder = room.path / "new"
        folder.mkdir()
        part = folder / target.name

        def commit() -> None:
            _settle(part)
            with shielded():
                if not _committed(part, target, seen):
                    kept = _keep(part, target)
                    expected = (
                        "a path that nothing else changes meanwhile; it is left as it is, and "
                        f"what was computed is kept in {kept}"
                    )
                    raise InputError("--out", out, expected)
                _sync(target.parent)

        yield part, commit


@contextmanager
def _refusing(out: Path, kind: str = "a path") -> Iterator[None]:
    """Say in one line why a path cannot be used; a full disk is no fault of the path's."""
    try:
        yield
    except Taken as holder:
        expected = f"{kind} that no other command is writing to ({holder})"
        raise InputError("--out", out, expected) from None
    except OSError as error:
        if error.errno in MACHINE:
            raise
        expected = f"a path in a writable directory ({error.strerror})"
        raise InputError("--out", out, expected) from None


def _real(out: Path) -> Path:
    """The path without symbolic links, so that one place has one claim.

    Raises:
        InputError: a link to nothing, or not text.
    """
    target = Path(os.path.realpath(out))
    try:
        str(target).encode()
    except UnicodeEncodeError:
        raise InputError("--out", ascii(str(target)), "a path in UTF-8") from None
    if not target.name:
        raise InputError("--out", out, "a path with a name")
    if out.is_symlink() and not target.exists():
        raise InputError("--out", out, f"a path that is no link to nothing ({target})")
    return target


def _checked(out: Path, force: bool, holds: tuple[str, ...], ours: Ours | None) -> Seen | None:
    """What is there and may be replaced; None: nothing is there.

    Raises:
        InputError: it may not be replaced, or nothing can be written there.
    """
    target = _real(out)
    if target.exists():
        if not force:
            raise InputError("--out", out, "a path that does not exist yet (or --force)")
        _check_replaceable(out, target, holds, ours)
    parent = next(p for p in target.parents if p.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        raise InputError("--out", out, f"a path in a writable directory ({parent} is not)")
    return _seen(target)


def _check_replaceable(out: Path, target: Path, holds: tuple[str, ...], ours: Ours | None) -> None:
    if target.is_dir():
        if Path.cwd().is_relative_to(target):
            raise InputError("--out", out, "a directory one is not in")
        names = {path.name for path in target.iterdir()}
        if names and not names & set(holds):
            expected = f"a directory to replace that holds {' or '.join(holds)}"
            raise InputError("--out", out, expected)
    elif not target.is_file():
        raise InputError("--out", out, "a file or a directory to replace")
    elif ours is not None and not ours(target):
        raise InputError("--out", out, "a file to replace that this command has written")


def _seen(target: Path) -> Seen | None:
    """What is at a path, so that any change shows."""
    if not target.exists():
        return None
    found = {"": _identity(target)}
    for folder, folders, files in os.walk(target):
        for name in (*folders, *files):
            path = Path(folder, name)
            with suppress(FileNotFoundError):  # gone since: a change that shows
                found[str(path.relative_to(target))] = _identity(path)
    return found


def _identity(path: Path) -> tuple[int, ...]:
    there = path.lstat()
    if stat.S_ISDIR(there.st_mode):
        return (there.st_dev, there.st_ino)
    return (there.st_dev, there.st_ino, there.st_size, there.st_mtime_ns)


def _make_parents(folder: Path) -> list[Path]:
    """Make a directory; what had to be made, innermost first."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for path in missing:
        _sync(path.parent)
    return missing


def _room_of(target: Path) -> Path:
    """Beside a target, the same whoever asks."""
    name = target.name
    if len(os.fsencode(name)) > LONGEST_NAME:
        name = hashlib.sha256(name.encode()).hexdigest()
    return target.with_name(f".{name}{SUFFIX}")


def _settle(path: Path) -> None:
    """Have a file, or a directory and all in it, on the disk before its name says so."""
    if path.is_dir():
        for part in path.iterdir():
            _settle(part)
    _sync(path)


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _committed(part: Path, target: Path, seen: Seen | None) -> bool:
    """Put what was made into its place, and what was there into `part`'s; False: it has changed."""
    try:
        if seen is None or not target.exists():
            place(part, target)
            return True
        spare = _free(target, "old")
        exchange(part, target, spare)
        if _seen(part) == seen:
            return True
        exchange(part, target, spare)
    except FileExistsError:
        pass
    return False


def _keep(part: Path, target: Path) -> Path:
    """Keep a result that found its place taken under a name beside it."""
    while True:
        kept = _free(target, "kept")
        with suppress(FileExistsError):
            place(part, kept)
            _sync(target.parent)
            return kept


def _free(target: Path, word: str) -> Path:
    """A free name beside a target that says what is there."""
    names = (f"{target.stem}.{word}-{n}{target.suffix}" for n in itertools.count(1))
    return next(path for path in map(target.with_name, names) if not path.exists())

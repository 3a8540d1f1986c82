"""Rooms: directories that one process works in, gone with it or cleared by the next command.

A room holds a lock that says who took it and dies with that process, however it ends (`flock`). A
room whose lock is free is stale: a killed process left it. Age says nothing.
"""

from __future__ import annotations

import atexit
import errno
import fcntl
import json
import os
import platform
import secrets
import shlex
import shutil
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from typing import Literal, TextIO

from realitygap.studies.plumbing.lifetime import shielded

LOCK = "realitygap.lock"
"""Name of the lock in a room; it marks a directory as one."""
PATIENCE = 10.0
"""s to wait for a lock that a dead process seems to hold: another command is clearing it away."""
POLL = 0.01
"""s between two tries at such a lock."""
LONGEST = 120
"""Characters of a holder's command that are shown; our choice."""
PREFIX = "realitygap-"
"""Of rooms for temporary files."""
INHERITED = "REALITYGAP_ROOM"
"""Variable that tells child processes of their command's room, which is gone with the command."""


_rooms: set[Room] = set()
_one_at_a_time = threading.Lock()


class Taken(Exception):
    """Another process has the room; says which."""


@dataclass(frozen=True)
class Holder:
    """Who has taken a room, as its lock says."""

    pid: int
    host: str
    command: str
    since: str
    """Local time."""

    @classmethod
    def this(cls) -> Holder:
        """This process."""
        command = shlex.join(["realitygap", *sys.argv[1:]])
        since = datetime.now().astimezone().isoformat(" ", "seconds")
        return cls(os.getpid(), platform.node(), command, since)

    @classmethod
    def read(cls, lock: TextIO) -> Holder | None:
        """None: the lock says nothing yet, or was not written whole."""
        lock.seek(0)
        try:
            return cls(**json.loads(lock.read()))
        except (ValueError, TypeError):
            return None

    @property
    def here(self) -> bool:
        """Whether it runs, or ran, on this machine."""
        return self.host == platform.node()

    @property
    def gone(self) -> bool:
        """Whether it has certainly ended."""
        return self.here and not Path(f"/proc/{self.pid}").exists()

    def __str__(self) -> str:
        shown = "".join(c if c.isprintable() else "?" for c in self.command)
        if len(shown) > LONGEST:
            shown = shown[:LONGEST] + "..."
        where = "" if self.here else f" on {self.host}"
        return f"process {self.pid}{where}, since {self.since}: {shown}"


class Room:
    """A directory that this process has taken."""

    def __init__(self, path: Path, lock: TextIO) -> None:
        self.path, self._lock = path, lock
        _rooms.add(self)

    def close(self) -> None:
        """Remove it with all that is in it."""
        with shielded(), self._lock:
            _rooms.discard(self)
            with suppress(OSError):  # what could not be removed stays marked by the lock
                _empty(self.path)
                if os.listdir(self.path) == [LOCK]:
                    (self.path / LOCK).unlink()
                    self.path.rmdir()


def take(path: Path) -> Room:
    """Make a directory a room of this process; what a killed process left in it is removed.

    Raises:
        Taken: another process has it.
        OSError: it cannot be made, or something else has its name.
    """
    end = time.monotonic() + PATIENCE
    while True:
        with shielded():
            room = _taken(path)
        if room is not None:
            return room
        if time.monotonic() > end:
            raise Taken("another process")
        time.sleep(POLL)


def _taken(path: Path) -> Room | None:
    """As `take`, once; None: another process is clearing it away just now."""
    with suppress(FileExistsError):
        path.mkdir(mode=0o700)
    try:
        names = os.listdir(path)
        if names and LOCK not in names:
            raise FileExistsError(errno.EEXIST, f"{path.name} is in the way", str(path))
        lock = _locked(path, "a+")
    except FileNotFoundError:
        return None
    if lock is None:
        return None
    room = Room(path, lock)
    _empty(path)
    lock.truncate(0)
    json.dump(asdict(Holder.this()), lock)
    lock.flush()
    return room


def _locked(path: Path, mode: Literal["a+", "r+"]) -> TextIO | None:
    """A room's lock, locked; None: it is being made or cleared away just now.

    Raises:
        Taken: a process that runs has it.
    """
    try:
        lock = (path / LOCK).open(mode, encoding="utf-8")
    except FileNotFoundError:
        return None
    with ExitStack() as closing:
        closing.enter_context(lock)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = Holder.read(lock)
            if holder is None or holder.gone:
                return None
            raise Taken(str(holder)) from None
        with suppress(FileNotFoundError):
            if os.path.samestat(os.stat(path / LOCK), os.fstat(lock.fileno())):
                closing.pop_all()
                return lock
    return None


def _empty(path: Path) -> None:
    """Remove what is in a room but its lock, as far as that goes."""
    for entry in os.scandir(path):
        if entry.name == LOCK:
            continue
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry, ignore_errors=True)
        else:
            with suppress(OSError):
                os.unlink(entry)


def close_rooms() -> None:
    """Remove every room of this process."""
    for room in list(_rooms):
        with suppress(OSError):
            room.close()


atexit.register(close_rooms)
os.register_at_fork(after_in_child=_rooms.clear)  # they are the parent's


def clear_stale(folder: Path, prefix: str, suffix: str) -> None:
    """Remove the rooms that killed processes of this machine left in a folder.

    Args:
        folder: The folder.
        prefix: Of the rooms' names.
        suffix: Of the rooms' names.
    """
    for entry in os.scandir(folder):
        if not (entry.name.startswith(prefix) and entry.name.endswith(suffix)):
            continue
        with suppress(OSError, Taken), shielded():
            lock = _locked(Path(entry), "r+") if entry.is_dir(follow_symlinks=False) else None
            if lock is None:
                continue
            holder = Holder.read(lock)
            if holder is None or holder.here:
                Room(Path(entry), lock).close()
            else:
                lock.close()


def clear_temporary() -> None:
    """Remove the rooms for temporary files that killed commands left."""
    clear_stale(Path(gettempdir()), PREFIX, "")


def command_room() -> Path:
    """The room for temporary files that a command shares with its child processes."""
    with _one_at_a_time:
        inherited = os.environ.get(INHERITED)
        if inherited and Path(inherited).is_dir():
            return Path(inherited)
        room = take(Path(gettempdir()).absolute() / f"{PREFIX}{secrets.token_hex(4)}")
        os.environ[INHERITED] = str(room.path)
        clear_temporary()
        return room.path


@contextmanager
def scratch() -> Iterator[Path]:
    """A temporary directory: gone after the block, and with the command if that is killed."""
    with TemporaryDirectory(dir=command_room()) as path:
        yield Path(path)

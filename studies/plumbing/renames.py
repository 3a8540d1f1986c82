"""Renaming that overwrites nothing, and exchanging that never leaves a name without content.

Linux's `renameat2` does both in one step. File systems without it (NFS, some FUSE) get the nearest
that POSIX has: a name is still never taken from anybody.
"""

from __future__ import annotations

import ctypes
import errno
import os
from functools import cache
from pathlib import Path
from typing import Any

AT_FDCWD = -100
NOREPLACE, EXCHANGE = 1, 2
"""From Linux's <fcntl.h> and <linux/fs.h>."""
UNSUPPORTED = (errno.ENOSYS, errno.EINVAL, errno.EOPNOTSUPP)
"""What kernels and file systems without these flags answer."""


def place(source: Path, target: Path) -> None:
    """Rename where nothing is.

    Without `renameat2` a directory replaces one that was made empty for it, and a file is linked.

    Raises:
        FileExistsError: `target` is there.
        OSError: it cannot be renamed.
    """
    if _renamed(source, target, NOREPLACE):
        return
    if source.is_dir():
        target.mkdir()
        try:
            os.rename(source, target)
        except OSError as error:
            if error.errno == errno.ENOTEMPTY:  # in that instant somebody has put a file there
                raise FileExistsError(errno.EEXIST, "is there", str(target)) from None
            raise
    else:
        os.link(source, target)
        source.unlink()


def exchange(one: Path, other: Path, spare: Path) -> None:
    """Let two paths change places.

    Args:
        one: A file or directory.
        other: Another.
        spare: A free name beside `other`. Without `renameat2` it holds `other` for an instant.

    Raises:
        OSError: a path is not there, or cannot be renamed.
    """
    if _renamed(one, other, EXCHANGE):
        return
    place(other, spare)
    place(one, other)
    place(spare, one)


def _renamed(source: Path, target: Path, flags: int) -> bool:
    """Whether the file system knows the flags, and so has renamed."""
    call = _renameat2()
    if call is None:
        return False
    if call(AT_FDCWD, os.fsencode(source), AT_FDCWD, os.fsencode(target), flags) == 0:
        return True
    number = ctypes.get_errno()
    if number in UNSUPPORTED:
        return False
    raise OSError(number, os.strerror(number), str(source), None, str(target))


@cache
def _renameat2() -> Any:
    """The C library's function; None: it has none."""
    return getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)

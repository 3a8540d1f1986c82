"""Standard output and error that may be closed, full, or read by nobody any more.

What cannot be written is dropped and remembered: work goes on, its files are what it is done for.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class Stream(io.RawIOBase):
    """A descriptor that never fails; the first error stands in `lost`."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self.lost: OSError | None = None

    def fileno(self) -> int:
        """The descriptor."""
        return self._descriptor

    def writable(self) -> bool:
        """It is."""
        return True

    def isatty(self) -> bool:
        """Whether a person reads it."""
        return os.isatty(self._descriptor)

    def write(self, content: ReadableBuffer) -> int:
        """Write all of it, or drop it."""
        rest = memoryview(content).cast("B")
        size = len(rest)
        try:
            while rest and self.lost is None:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError as error:
            self.lost = error
        return size

    @property
    def failed(self) -> str | None:
        """Why something was lost; None: nothing was, or the reader had seen enough."""
        if self.lost is None or self.lost.errno == errno.EPIPE:
            return None
        return self.lost.strerror


def open_streams() -> tuple[Stream, Stream]:
    """Put such streams in the place of the process's own.

    A closed descriptor is opened on nothing, or the next file would get its number and whatever a
    library prints. Streams that something else has put there, as a test does, stay.

    Returns:
        Those of standard output and standard error.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDONLY)  # gets the lowest free number; refuses what is written
    out, err = Stream(1), Stream(2)
    if sys.stdout is sys.__stdout__:
        sys.stdout = _text(out, sys.stdout)
    if sys.stderr is sys.__stderr__:
        sys.stderr = _text(err, sys.stderr)
    return out, err


def _text(stream: Stream, before: TextIO | None) -> io.TextIOWrapper:
    """Lines in the encoding there was; what that lacks is shown by its number."""
    return io.TextIOWrapper(
        io.BufferedWriter(stream),
        encoding=None if before is None else before.encoding,
        errors="backslashreplace",
        line_buffering=True,
    )

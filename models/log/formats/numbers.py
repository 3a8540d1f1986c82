"""Plain text with a row of numbers in each line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import InputError
from realitygap.models.log.opened import opened, parsing

MOST_BYTES = 2**28
"""Of a file. Our choice: a robot's poses at 100 Hz for half a day."""


def read_plain(path: Path, expected: str) -> str:
    """A text file; what is no UTF-8 is replaced, as in remarks.

    Raises:
        InputError: as `log.opened.opened`.
    """
    with opened(path, expected, most=MOST_BYTES, field="source") as file:
        return file.read(MOST_BYTES).decode("utf-8", errors="replace")


def read_numbers(
    path: Path, columns: int, expected: str, *, delimiter: str | None = None
) -> npt.NDArray[np.float64]:
    """(rows, columns) of a file; empty lines and those that start with `#` are left out.

    Raises:
        InputError: as `read_plain` and `numbers`.
    """
    text = read_plain(path, expected).splitlines()
    lines = [line for line in text if line.strip() and not line.startswith("#")]
    return numbers(lines, path, columns, delimiter=delimiter)


def numbers(
    lines: list[str], path: Path, columns: int, *, delimiter: str | None = None
) -> npt.NDArray[np.float64]:
    """(rows, columns) the first numbers of each line, between `delimiter` or white space.

    Raises:
        InputError: fewer than two lines, or one without so many finite numbers.
    """
    if len(lines) < 2:
        raise InputError(str(path), f"{len(lines)} rows", "at least two rows")
    with parsing(str(path), f"{columns} numbers in each row"):
        values = np.loadtxt(lines, delimiter=delimiter, usecols=range(columns), ndmin=2)
    if not np.isfinite(values).all():
        raise InputError(str(path), "values that are not finite", "numbers")
    return values

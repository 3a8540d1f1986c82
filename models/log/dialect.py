"""How a table is written as text: what stands between its columns, and in its numbers.

Both are read off the first lines. The separator is the one of semicolon, tab, comma and blanks that
divides the header and the first row into equally many parts. The decimal sign is a comma if some
number of the first rows has one and none has a point.
"""

from __future__ import annotations

import csv
import re
from typing import NamedTuple

BLANKS = r"\s+"
"""As pandas takes white space of any length."""
ROWS = 50
"""Rows whose numbers are looked at. Our choice: a table of whole numbers alone has no sign."""
_COMMA = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?")
_POINT = re.compile(r"[+-]?\d*\.\d+(?:[eE][+-]?\d+)?")


class Dialect(NamedTuple):
    """One way of writing."""

    separator: str = ","
    decimal: str = "."


def dialect(head: bytes) -> Dialect:
    """The dialect of a table by its first bytes; the usual one where they do not tell."""
    lines = [line for line in head.decode("utf-8-sig", "replace").splitlines() if line.strip()]
    first = lines[: ROWS + 1]
    separator = next((s for s in (";", "\t", ",", BLANKS) if _divides(first[:2], s)), ",")
    cells = [cell.strip() for line in first[1:] for cell in _cells(line, separator)]
    comma = any(_COMMA.fullmatch(cell) for cell in cells)
    point = any(_POINT.fullmatch(cell) for cell in cells)
    return Dialect(separator, "," if comma and not point else ".")


def _divides(lines: list[str], separator: str) -> bool:
    """Whether a separator makes of every line the same number of cells, and more than one."""
    widths = {len(_cells(line, separator)) for line in lines}
    return len(widths) == 1 and widths.pop() > 1


def _cells(line: str, separator: str) -> list[str]:
    if separator == BLANKS:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:  # a field longer than any number, a NUL
        return []

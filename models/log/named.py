"""Robots that a log calls by name: a number for each, kept with the name.

Everything that is computed knows robots by number; whatever is told of them calls them by name.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import pandas as pd

from realitygap.embedded_sim import InputError

LONGEST = 60
"""Letters of a name. Our choice: a column of texts of any length names no robots."""


class Names(dict[int, str]):
    """By number what a robot is called; one without a name is called by its number."""

    def __missing__(self, robot: int) -> str:
        return str(robot)

    def key(self, robot: int) -> int | str:
        """What stands for a robot in a table: its name, or its number where it has none."""
        return self.get(robot, robot)


def numbered(
    robots: pd.Series[int], known: Mapping[str, int] | None = None
) -> tuple[pd.Series[int], Names]:
    """A column of robots as numbers, and what they are called.

    A column of numbers, also of numbers written as text, stays as it is. Names get the smallest
    free numbers in natural order (robot2 before robot10).

    Args:
        robots: (rows,) numbers or texts; what is neither is left for whoever checks the column.
        known: Numbers that some names have already, as in an extended model.

    Raises:
        InputError: a name is longer than any robot's.
    """
    values = robots.dropna()
    if not len(values) or pd.api.types.is_numeric_dtype(values.dtype):
        return robots, Names()
    unique = list(pd.unique(values))
    if not all(isinstance(one, str | int) and not isinstance(one, bool) for one in unique):
        return robots, Names()
    if not pd.to_numeric(pd.Series([str(one) for one in unique]), errors="coerce").isna().any():
        return robots, Names()
    longest = max((str(one) for one in unique), key=len)
    if len(longest) > LONGEST:
        raise InputError("column robot", longest, f"names of at most {LONGEST} letters")
    given = dict(known or {})
    for name in sorted({str(one) for one in unique} - set(given), key=_natural):
        given[name] = _free(given)
    numbers = robots.map(lambda one: one if pd.isna(one) else given[str(one)])
    called = {str(one) for one in unique}
    return numbers, Names({number: name for name, number in given.items() if name in called})


def _free(given: dict[str, int]) -> int:
    taken = set(given.values())
    return next(number for number in range(len(taken) + 1) if number not in taken)


def _natural(name: str) -> list[tuple[int, int, str]]:
    """Sorts parts of digits by their number."""
    parts = re.split(r"([0-9]+)", name)
    return [(0, int(p), "") if p.isdecimal() and p.isascii() else (1, 0, p) for p in parts if p]

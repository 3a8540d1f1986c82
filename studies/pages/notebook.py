"""How a result shows itself in a notebook: a headline, what it says, where to look."""

from __future__ import annotations

import textwrap
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

WIDTH = 100
"""Letters of a line."""


class Telling(ABC):
    """A result that tells of itself in a few lines."""

    @abstractmethod
    def told(self) -> tuple[str, str, str]:
        """Headline, text (a line each becomes one or several), names of attributes to look at."""

    def __repr__(self) -> str:
        headline, text, look = self.told()
        lines = [
            textwrap.fill(line, WIDTH, initial_indent="  ", subsequent_indent="  ")
            for line in text.splitlines()
        ]
        return "\n".join([headline, *lines, f"  see {look}"])


def rows_table(
    rows: Sequence[Mapping[Any, Any]], columns: Sequence[str], numbers: Sequence[str] = ()
) -> pd.DataFrame:
    """Rows as a table with just these columns, in this order, also without rows.

    Args:
        rows: By column.
        columns: Of the table.
        numbers: Those of them that hold numbers; None becomes NaN.
    """
    table = pd.DataFrame([dict(row) for row in rows], columns=list(columns))
    return table.astype(dict.fromkeys(numbers, float))

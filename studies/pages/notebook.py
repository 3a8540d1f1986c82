"""How a result shows itself in a notebook: a headline, what it says, a table, a picture."""

from __future__ import annotations

import textwrap
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import pandas as pd
from markupsafe import escape

from realitygap.studies.plumbing.output import whole_directory

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH = 100
"""Letters of a line."""
MOST_ROWS = 12
"""Rows of a table that are shown unasked."""


class Telling(ABC):
    """A result that tells of itself in a few lines."""

    @abstractmethod
    def told(self) -> tuple[str, str, str]:
        """Headline, text (a line each becomes one or several), names of attributes to look at."""

    @abstractmethod
    def table_told(self) -> pd.DataFrame | None:
        """The table that it shows unasked; None: none."""

    @abstractmethod
    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw it; returns the matplotlib axes.

        Args:
            axes: To draw into; new ones if absent.
        """

    def __repr__(self) -> str:
        headline, text, look = self.told()
        lines = [
            textwrap.fill(line, WIDTH, initial_indent="  ", subsequent_indent="  ")
            for line in text.splitlines()
        ]
        return "\n".join([headline, *lines, f"  see {look}"])

    def _repr_html_(self) -> str:
        headline, text, look = self.told()
        lines = "".join(f"<p>{escape(line)}</p>" for line in text.splitlines())
        table = self.table_told()
        shown = "" if table is None else html_table(table)
        return f"<div><h4>{escape(headline)}</h4>{lines}{shown}<p>see {escape(look)}</p></div>"


class WrittenResult(ABC):
    """A result that can be written, as files of which one says whose they are."""

    holds: ClassVar[str]
    """Name of that file."""

    @abstractmethod
    def keep(self, folder: Path) -> None:
        """Write its files into a directory that is there."""

    def write(self, out: Path | str, *, force: bool = False) -> None:
        """Write its files into a new directory.

        Args:
            out: The directory.
            force: Replace what a former call has written.

        Raises:
            InputError: `out` is there already or cannot be written.
        """
        with whole_directory(Path(out), force=force, holds=(self.holds,)) as part:
            self.keep(part)


def html_table(table: pd.DataFrame) -> str:
    """A table's first rows as HTML, text as text, numbers to four digits."""
    if not len(table):
        return ""
    first = table.head(MOST_ROWS)
    more = f"<p>and {len(table) - MOST_ROWS} rows more</p>" if len(table) > MOST_ROWS else ""
    return str(first.to_html(index=False, border=0, float_format="{:.4g}".format, na_rep="")) + more


def new_axes(axes: Axes | None) -> Axes:
    """Those given, or new ones, which a notebook shows."""
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    return plt.subplots(figsize=(6.4, 4.4), layout="constrained")[1]


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

"""What naming asks of a robot: white errors at whatever is believed of it, and columns of them.

A robot of a log has errors that are independent and of unit variance (*white*), once its noise is
known. Which channel they come from, pose windows or readings, is nobody's business here.
"""

from __future__ import annotations

from typing import Any, Protocol

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.log.frames import Rows
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item


class Subject(Protocol):
    """A robot at what is believed of it (`Motion` or `Belief`), with its noise."""

    @property
    def motion(self) -> Any:
        """What is believed of it, at which its columns were made."""

    @property
    def items(self) -> tuple[Item, ...]:
        """What may be the matter, over the columns."""

    @property
    def names(self) -> tuple[str, ...]:
        """(k,) of the columns; equal names mean the same in every log."""

    @property
    def information(self) -> FloatArray:
        """(k, k) products of the white columns."""

    @property
    def own_errors(self) -> FloatArray:
        """(rows,) white errors at what is believed."""

    @property
    def block(self) -> Rows:
        """(windows,) block of each window; -1: windows that are independent of all others."""

    def errors(self, motion: Any) -> FloatArray:
        """(rows,) white errors if something else is believed."""

    def pulled(self, rows: FloatArray) -> FloatArray:
        """(p, k) products of (rows, p) white ones with the columns."""

    def by_window(self, rows: FloatArray) -> FloatArray:
        """(windows,) sums of (rows,) over each window."""

    def by_run(self, column: int) -> list[FloatArray]:
        """Of each run, (rows,) a white column there and 0 elsewhere."""

    def applied(self, motion: Any, term: Term, coordinates: FloatArray) -> Any:
        """What is believed with a cause."""

    def without(self, window: int) -> Subject:
        """The robot as if one window said nothing."""

    def moved(self, motion: Any, tracks: Any) -> Subject:
        """The robot at something else, its noise learned anew; `tracks` is the whole log."""

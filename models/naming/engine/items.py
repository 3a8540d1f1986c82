"""What may be the matter, and which columns show it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from realitygap.models.naming.engine.hypothesis import Term

Mask = npt.NDArray[np.bool_]
"""Of columns, or of robots."""


class Item(NamedTuple):
    """One thing that may be the matter: a cause, at a dose or per unit, or a flexible term."""

    term: Term | None
    dose: tuple[float, ...] | None
    """Coordinates of a whole dose; None: columns are per unit of each coordinate."""
    quantity: str
    channel: str
    columns: tuple[int, ...]
    always: int = -1
    """Of a flexible term, the column in which its channel changes whatever the quantity."""

    @property
    def of(self) -> Term:
        """Of a cause."""
        assert self.term is not None
        return self.term

    @property
    def key(self) -> str:
        """A name for tables."""
        if self.term is not None:
            return self.term.key
        return f"{self.channel}/{self.quantity}"

"""A channel's columns while they are made: by name, with what each may be."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.channels.motion.columns import Columns
from realitygap.models.naming.engine.items import Item


class Kind(NamedTuple):
    """Something that may be the matter, over names of columns."""

    item: Item
    columns: tuple[str, ...]
    always: str = ""
    """Of what follows a quantity, the column in which its channel changes steadily."""

    def over(self, where: Mapping[str, int]) -> Item:
        """The same over their indices."""
        always = where.get(self.always, -1)
        return self.item._replace(columns=tuple(where[n] for n in self.columns), always=always)


class Made:
    """Of one robot and channel."""

    def __init__(self, errors: FloatArray) -> None:
        self.errors = errors
        self.values: dict[str, FloatArray] = {}
        """(n,) by name."""
        self.items: dict[tuple[str, tuple[float, ...] | None], Kind] = {}
        """By key and dose."""
        self.windows = np.zeros((len(errors), 0))
        """(n, q)."""

    def add(self, item: Item | None, columns: Mapping[str, FloatArray]) -> None:
        """Columns of a cause, or of nothing that may be the matter."""
        self.values |= columns
        if item is not None:
            self.items[item.key, item.dose] = Kind(item, tuple(columns))

    def flexible(self, channel: str, quantity: str, part: str, values: FloatArray) -> None:
        """A column of what follows a quantity; sine and cosine, and both axes, are one thing."""
        words = [word for word in part.split() if word not in ("sin", "cos", "x", "y")]
        item = Item(None, None, " ".join([quantity, *words]), channel, ())
        name = f"{channel}/{quantity}{part}"
        before: Sequence[str] = ()
        if (item.key, None) in self.items:
            before = self.items[item.key, None].columns
        self.values[name] = values
        self.items[item.key, None] = Kind(item, (*before, name), f"{channel}/always")

    def only(self, names: Container[str]) -> None:
        """Leave out columns of other names."""
        self.values = {name: one for name, one in self.values.items() if name in names}

    @property
    def columns(self) -> Columns:
        """As noise is learned of."""
        values = np.array(list(self.values.values())).reshape(-1, len(self.errors)).T
        return Columns(
            self.errors[:, None],
            (),
            tuple(self.values),
            values[:, None, :],
            self.windows[:, None, :],
        )

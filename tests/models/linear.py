"""Robots whose errors are linear in every term, so that the answers of naming are known.

A toy's motion is the list of causes that were applied to it. Its rows are white already: each is a
row of y = X (m + a + u) + J c + e with e of variance 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.cause import Cause, Parameter
from realitygap.models.naming.channels.motion.tracks import BLOCK_WINDOWS, Tracks
from realitygap.models.naming.engine.health import Health
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item
from realitygap.models.naming.engine.state import State
from tests.models.toys import WIDE, tracks

Applied = tuple[tuple[str, FloatArray], ...]


def cause(name: str, size: int = 1, *, sign: int = 0, null: float = 0.0, **more: Any) -> Term:
    """A term whose column is that of its name."""

    def change(motion: Any, values: FloatArray, variant: str) -> Any:
        return (*motion, (name, values))

    parameters = tuple(
        Parameter(name=f"p{k}", unit="1", null=null, low=-WIDE, high=WIDE, step=1.0, sign=sign)
        for k in range(size)
    )
    made = Cause(name=name, meaning=name, parameters=parameters, change=change, **more)
    return Term(made, "")


def item(term: Term, *columns: int, dose: float | None = None) -> Item:
    """Of a cause."""
    return Item(term, None if dose is None else (dose,), "", "", columns)


def flexible(quantity: str, *columns: int, always: int = -1) -> Item:
    """Of what follows a quantity."""
    return Item(None, None, quantity, "speed", columns, always)


def name_of(one: Item, k: int) -> str:
    """Of a column, as `columns` names it."""
    if one.dose is not None:
        return f"{one.key}@{one.dose[0]:g}"
    return f"{one.key}.p{k}" if one.term is not None else f"{one.key} {k}"


@dataclass(frozen=True, eq=False)
class ToyRobot:
    """What naming asks of a robot."""

    tracks: Tracks
    motion: Any
    made: Any
    y: FloatArray
    """(rows,)."""
    columns: FloatArray
    """(rows, k)."""

    @property
    def items(self) -> Any:
        return self.made.items

    @property
    def names(self) -> Any:
        return self.made.names

    @property
    def block(self) -> Any:
        return self.tracks.block

    def pulled(self, rows: FloatArray) -> FloatArray:
        """(p, k)."""
        return np.asarray(rows.T @ self.columns)

    def by_window(self, rows: FloatArray) -> FloatArray:
        """(windows,)."""
        return np.asarray(rows.reshape(len(self.tracks.first), -1).sum(axis=1))

    def by_run(self, column: int) -> list[FloatArray]:
        """Of each run, (rows,) its column there."""
        run = self.tracks.row_segment[self.tracks.rows[self.tracks.first]]
        white = self.columns[:, column].reshape(len(run), -1)
        return [np.where((run == one)[:, None], white, 0.0).ravel() for one in np.unique(run)]

    def applied(self, motion: Any, term: Term, coordinates: FloatArray) -> Any:
        """A motion with a cause."""
        return term.cause.applied(motion, coordinates, term.variant)

    def without(self, window: int) -> ToyRobot:
        """One window is empty."""
        y, columns = self.y.copy(), self.columns.copy()
        windows = len(self.tracks.first)
        y.reshape(windows, -1)[window] = 0.0
        columns.reshape(windows, -1, columns.shape[1])[window] = 0.0
        return replace(self, y=y, columns=columns)

    def moved(self, motion: Any, _: Any) -> Any:
        """Elsewhere, where its columns are the same."""
        return replace(self, motion=motion)

    @property
    def information(self) -> FloatArray:
        """(k, k)."""
        return np.asarray(self.columns.T @ self.columns)

    @property
    def own_errors(self) -> FloatArray:
        """(rows,)."""
        return self.errors(self.motion)

    def errors(self, motion: Applied) -> FloatArray:
        """(rows,) with the causes of a motion taken off."""
        left = self.y.copy()
        for name, values in motion:
            at = next(
                one.columns
                for one in self.made.items
                if one.term is not None and one.dose is None and one.of.cause.name == name
            )
            left -= self.columns[:, at] @ values
        return left


def nobody() -> Health:
    """Of whom nothing was measured."""
    return Health((), np.zeros(0), np.zeros((0, 0)), np.zeros(0), 0, 0)


def state_of(
    y: FloatArray, x: FloatArray, items: Sequence[Item], health: Health | None = None
) -> State:
    """A log of toys.

    Args:
        y: (robots, rows).
        x: (robots, rows, k).
        items: Over the columns.
        health: None: nothing differs.
    """
    robots, rows, many = x.shape
    per_window = rows // BLOCK_WINDOWS // 5
    cut = tracks(robots, rows // (per_window * BLOCK_WINDOWS), per_window * BLOCK_WINDOWS)
    names = [f"free@{k}" for k in range(many)]
    for one in items:
        for k, c in enumerate(one.columns):
            names[c] = name_of(one, k)
    made = SimpleNamespace(items=tuple(items), names=tuple(names))
    each = tuple(ToyRobot(cut.only([k]), (), made, y[k], x[k]) for k in range(robots))
    base: Any = ((),) * robots
    toys: Any = each
    return State(cut, base, toys, health or nobody())


def sound(names: Sequence[str], sd: Sequence[float], swarm: Sequence[float]) -> Health:
    """With these standard deviations between robots and between swarms, known for sure."""
    sure = 10**9  # so many are no sample that would be widened
    return Health(
        tuple(names), np.zeros(len(names)), np.diag(np.square(sd)), np.square(swarm), sure, sure
    )

"""Which causes are tried on the senses: per unit of their coordinates, or at whole doses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.belief.catalogue import sense_causes, withheld
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.items import Item

NO_COMMANDS: FloatArray = np.zeros((0, 2))

Doses = Mapping[Term, Sequence[FloatArray]]
"""Coordinates (parameters,) that a term is tried at as they are, beside its own."""
Errors = Callable[[Belief], FloatArray]
"""(n,) errors of a channel in noise if something is believed."""


def sense_terms() -> Iterator[Term]:
    """Every term of the catalogue of the senses."""
    for cause in sense_causes().values():
        if not withheld(cause.name):
            yield from (Term(cause, variant) for variant in cause.variants)


def applied(belief: Belief, term: Term, coordinates: FloatArray) -> Belief:
    """A belief with a cause."""
    assert isinstance(term.cause, SenseCause)
    return term.cause.believed(belief, coordinates, term.variant)


def items_of(term: Term, doses: Doses) -> list[tuple[Item, list[str]]]:
    """What a term may be, each with the names of its columns."""
    found = []
    if term.cause.parameters:
        names = [f"{term.key}.{p.name}" for p in term.cause.parameters]
        found.append((Item(term, None, "", "", ()), names))
    whole = [*term.cause.starts(NO_COMMANDS), *doses.get(term, ())]
    for dose in whole if term.cause.parameters else [np.zeros(0)]:
        label = ",".join(f"{v:.6g}" for v in dose)
        found.append((Item(term, tuple(dose.tolist()), "", "", ()), [f"{term.key}@{label}"]))
    return found


def columns_of(item: Item, belief: Belief, errors: Errors) -> list[FloatArray]:
    """(n,) what each of an item's columns adds to the errors."""
    term = item.of
    if item.dose is not None:
        return [errors(belief) - errors(applied(belief, term, np.array(item.dose)))]
    found = []
    for k, p in enumerate(term.cause.parameters):
        low, high = p.bounds
        up, down = min(p.step, high), max(-p.step, low)
        sides = []
        for value in (up, down):
            there = np.zeros(len(term.cause.parameters))
            there[k] = value
            sides.append(errors(applied(belief, term, there)))
        found.append((sides[1] - sides[0]) / (up - down))
    return found

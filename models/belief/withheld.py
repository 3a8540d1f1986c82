"""Causes that a diagnosis is to do without, as if nobody had thought of them.

A catalogue is never complete. Taking an entry away shows what a diagnosis says of a fault that it
has no name for, on faults of which everything else is known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_NAMES: ContextVar[frozenset[str]] = ContextVar("withheld", default=frozenset())


@contextmanager
def without(names: Iterable[str]) -> Iterator[None]:
    """Within it, the causes of these names are not tried and not named."""
    token = _NAMES.set(_NAMES.get() | frozenset(names))
    try:
        yield
    finally:
        _NAMES.reset(token)


def withheld(name: str) -> bool:
    """Whether the cause of this name is not to be tried."""
    return name in _NAMES.get()

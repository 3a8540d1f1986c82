"""Every cause of the catalogue: those that show in motion and those that show in the senses.

They are found by being in a module of `belief/causes`. A cause's name and parameters are those of
the physical effect it explains, written independently of how the effect is made.

A diagnosis does without some. They are taken away, as if nobody had thought of them: a catalogue is
never complete, and this shows what a diagnosis says of a fault that it has no name for. Others have
no meaning for a robot, or are the same as another where more is known of it (`Cause.where`).
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache

from realitygap.models.belief import causes as folder
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.senses import SenseCause


@cache
def every_cause() -> dict[str, Cause]:
    """Every cause by name, in alphabetical order."""
    names = (f"{folder.__name__}.{module.name}" for module in pkgutil.iter_modules(folder.__path__))
    modules = map(importlib.import_module, names)
    found = [one for module in modules for one in vars(module).values() if isinstance(one, Cause)]
    return {cause.name: cause for cause in sorted(found, key=lambda cause: cause.name)}


@cache
def causes() -> dict[str, Cause]:
    """Those that show in motion."""
    return {name: c for name, c in every_cause().items() if not isinstance(c, SenseCause)}


@cache
def sense_causes() -> dict[str, SenseCause]:
    """Those that show in sensors, lamps and task."""
    return {name: c for name, c in every_cause().items() if isinstance(c, SenseCause)}


UNMEASURED = "unmeasured"
"""The fact that no healthy robot's motion is known."""
_NAMES: ContextVar[frozenset[str]] = ContextVar("withheld", default=frozenset())
_FACTS: ContextVar[frozenset[str]] = ContextVar("facts", default=frozenset({"differential"}))


@contextmanager
def without(names: Iterable[str]) -> Iterator[None]:
    """Within it, the causes of these names are not tried and not named."""
    token = _NAMES.set(_NAMES.get() | frozenset(names))
    try:
        yield
    finally:
        _NAMES.reset(token)


@contextmanager
def where(drive_kind: str, *, measured: bool = True) -> Iterator[None]:
    """Within it, the causes that make sense of such a robot are tried.

    Args:
        drive_kind: As the model file has it.
        measured: Whether a healthy reference says how such robots move.
    """
    token = _FACTS.set(frozenset({drive_kind} if measured else {drive_kind, UNMEASURED}))
    try:
        yield
    finally:
        _FACTS.reset(token)


def any_withheld() -> bool:
    """Whether some cause is taken away, so that it may come back under another name."""
    return bool(_NAMES.get())


def withheld(name: str) -> bool:
    """Whether the cause of this name is not to be tried."""
    asked = every_cause()[name].where
    return name in _NAMES.get() or (bool(asked) and asked not in _FACTS.get())

"""The catalogue of causes that show in motion: one module each, found by being here.

A module of this package defines `CAUSE`: its name and parameters are those of the physical effect
it explains, written independently of how the effect is made.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from realitygap.models.causes.cause import ALL, Cause, Parameter
from realitygap.models.causes.motion import Motion

__all__ = ["ALL", "Cause", "Motion", "Parameter", "causes"]

_MACHINERY = ("cause", "grip", "motion", "withheld")


@cache
def causes() -> dict[str, Cause]:
    """Every cause by name, in alphabetical order."""
    found: dict[str, Cause] = {}
    for module in sorted(pkgutil.iter_modules(__path__), key=lambda m: m.name):
        if module.name not in _MACHINERY:
            cause: Cause = importlib.import_module(f"{__name__}.{module.name}").CAUSE
            found[cause.name] = cause
    return found

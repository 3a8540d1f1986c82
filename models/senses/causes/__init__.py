"""The catalogue of causes that show in sensors, lamps and task: one module each.

A module of this package defines `CAUSE`: its name and parameters are those of the physical effect
it explains, written independently of how the effect is made.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from realitygap.models.senses.cause import SenseCause


@cache
def sense_causes() -> dict[str, SenseCause]:
    """Every cause by name, in alphabetical order."""
    found: dict[str, SenseCause] = {}
    for module in sorted(pkgutil.iter_modules(__path__), key=lambda m: m.name):
        cause: SenseCause = importlib.import_module(f"{__name__}.{module.name}").CAUSE
        found[cause.name] = cause
    return found

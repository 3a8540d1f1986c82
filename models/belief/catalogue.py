"""Every cause of the catalogue: those that show in motion and those that show in the senses.

They are found by being in a module of `belief/causes`. A cause's name and parameters are those of
the physical effect it explains, written independently of how the effect is made.
"""

from __future__ import annotations

import importlib
import pkgutil
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

"""Physical effects that can be hidden in reality, found by being in a module of this package.

An effect's name and parameters are the ones written in `--effect NAME:key=value,...`; it changes
the hardware of the chosen robots before the world is built. Nothing of it is ever written to what a
diagnosis reads.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from realitygap.reality.effects.effect import Effect, Key
from realitygap.reality.effects.spec import HiddenEffect, parse

__all__ = ["Effect", "HiddenEffect", "Key", "catalogue", "parse_effects"]


@cache
def catalogue() -> dict[str, Effect]:
    """Every effect by name, in alphabetical order."""
    modules = (
        importlib.import_module(f"{__name__}.{m.name}") for m in pkgutil.iter_modules(__path__)
    )
    found = [one for module in modules for one in vars(module).values() if isinstance(one, Effect)]
    return {effect.name: effect for effect in sorted(found, key=lambda effect: effect.name)}


def parse_effects(
    specs: list[str] | tuple[str, ...],
    robots: int,
    unlisted: Mapping[str, Effect] = MappingProxyType({}),
) -> tuple[HiddenEffect, ...]:
    """Read `NAME:key=value[,key=value...]` texts for a swarm of so many robots.

    Args:
        specs: The texts.
        robots: How many there are.
        unlisted: Effects, by name, that may be hidden beside those of the catalogue.

    Raises:
        InputError: an unknown effect or key, a value that is no number or out of bounds, a robot
            that does not exist, a parameter missing or given twice.
    """
    return tuple(parse(spec, {**catalogue(), **unlisted}, robots) for spec in specs)

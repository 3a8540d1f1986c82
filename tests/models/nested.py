"""Values in nested tables and lists, one by one."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

Keys = tuple[str | int, ...]


def leaves(values: object, keys: Keys = ()) -> Iterator[tuple[Keys, object]]:
    """Every value in nested tables and lists, and the way to it."""
    if not isinstance(values, dict | list):
        yield keys, values
        return
    for key, value in values.items() if isinstance(values, dict) else enumerate(values):
        yield from leaves(value, (*keys, key))


def replaced(values: Any, keys: Keys, value: object) -> Any:
    """The same with one value exchanged."""
    changed = copy.deepcopy(values)
    inner = changed
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    return changed

"""Quantities that cannot be behind what is seen: of another time, or another robot's."""

from __future__ import annotations

from copy import copy

import numpy as np

from realitygap.models.naming.laws.columns import LawColumns


def shifted(shown: LawColumns, share: float) -> LawColumns:
    """With quantities of another time."""
    moved = copy(shown)
    by = int(share * len(shown.known["time"]))
    moved.known = {name: np.roll(values, by, axis=0) for name, values in shown.known.items()}
    return moved


def of_another(shown: LawColumns, other: LawColumns) -> LawColumns:
    """With quantities of another robot at the same time."""
    moved = copy(shown)
    there = other.known["time"]
    order = np.argsort(there, kind="stable")
    at = np.searchsorted(there[order], shown.known["time"]).clip(0, len(there) - 1)
    moved.known = {
        name: values[order][at] for name, values in other.known.items() if name in shown.known
    }
    return moved

"""What the diagnosis can be tried on: the effects it has a cause for."""

from __future__ import annotations

from realitygap.models.belief.catalogue import every_cause
from realitygap.studies.hidden.menu import MENU


def known_effects() -> tuple[str, ...]:
    """Names in the menu's order."""
    return tuple(name for name in MENU if name in every_cause())

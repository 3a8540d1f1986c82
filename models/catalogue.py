"""Every cause of the catalogue: those that show in motion and those that show in the senses."""

from __future__ import annotations

from realitygap.models.causes import Cause, causes
from realitygap.models.senses.causes import sense_causes


def every_cause() -> dict[str, Cause]:
    """Every cause by name, in alphabetical order."""
    both: dict[str, Cause] = {**causes(), **sense_causes()}
    return dict(sorted(both.items()))

"""One thing that a log says of itself, and what follows from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Follows = Literal["nothing", "modelled", "repaired", "silences"]
"""`modelled`: believed of all robots alike, or counted as noise; `repaired`: the rows concerned are
set aside or bridged; `silences`: the causes listed cannot be told."""


@dataclass(frozen=True, kw_only=True)
class PreflightEntry:
    """A measured value and what follows from it."""

    name: str
    meaning: str
    """What it is, in words."""
    value: float | bool | str | None
    """None: this log does not tell."""
    unit: str = ""
    """SI; `1` for shares and counts; empty for words and for yes and no."""
    low: float | None = None
    high: float | None = None
    """95 %; None: no interval is known."""
    follows: Follows = "nothing"
    why: str = ""
    """What follows, in words."""
    causes: tuple[str, ...] = ()
    """That are silenced, or named only beyond what this may feign."""

"""What is asked of a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from realitygap.studies.typed import option, typed


@dataclass(frozen=True, kw_only=True)
class Request:
    """What to diagnose and with what."""

    logs: tuple[Path, ...]
    model: str | None = None
    reference: str | None = None
    seed: int = 0
    without: tuple[str, ...] = ()
    """Causes of the catalogue that are not to be tried."""

    @property
    def command(self) -> str:
        """What a user would type."""
        words: list[object] = ["realitygap", "diagnose", *self.logs]
        words += ["--model", self.model] if self.model else []
        words += ["--reference", self.reference] if self.reference else []
        words += ["--seed", self.seed] if self.seed else []
        return typed(*words, *option("--without", self.without))

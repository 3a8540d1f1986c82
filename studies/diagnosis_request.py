"""What is asked of a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


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
        words = ["realitygap diagnose", *(str(path) for path in self.logs)]
        words += [f"--model {self.model}"] if self.model else []
        words += [f"--reference {self.reference}"] if self.reference else []
        words += [f"--seed {self.seed}"] if self.seed else []
        words += [f"--without {name}" for name in self.without]
        return " ".join(words)

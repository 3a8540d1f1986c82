"""What `realitygap gain` is asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from realitygap.studies.typed import option, typed


@dataclass(frozen=True, kw_only=True)
class GainRequest:
    """Whose gain to measure, and in which runs."""

    logs: tuple[Path, ...]
    extended: str
    effects: tuple[str, ...] = ()
    healthy: tuple[Path, ...] = ()
    transfer: Path | None = None
    runs: int = 6
    minutes: float = 2.0
    seed: int = 0
    jobs: int | None = None

    @property
    def command(self) -> str:
        """What a user would type."""
        words: list[object] = ["realitygap", "gain", *option("--log", self.logs)]
        words += ["--extended", self.extended, *option("--effect", self.effects)]
        words += option("--healthy", self.healthy)
        words += ["--transfer", self.transfer] if self.transfer else []
        if self.effects:
            words += ["--runs", self.runs, "--minutes", f"{self.minutes:g}", "--seed", self.seed]
        return typed(*words)

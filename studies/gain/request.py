"""What `realitygap gain` is asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


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
        words = ["realitygap gain", *(f"--log {path}" for path in self.logs)]
        words += [f"--extended {self.extended}"]
        words += [f"--effect {one}" for one in self.effects]
        words += [f"--healthy {path}" for path in self.healthy]
        words += [f"--transfer {self.transfer}"] if self.transfer else []
        if self.effects:
            words += [f"--runs {self.runs} --minutes {self.minutes:g} --seed {self.seed}"]
        return " ".join(words)

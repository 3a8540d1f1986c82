"""What `realitygap gain` is asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from realitygap.models.belief.modelfile import DEFAULT as ROBOT
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.inputs.logs import Source
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.typed import option, typed


@dataclass(frozen=True, kw_only=True)
class GainRequest:
    """Whose gain to measure, and in which runs."""

    logs: tuple[Source, ...]
    extended: Model
    effects: tuple[str, ...] = ()
    healthy: tuple[Source, ...] = ()
    transfer: Path | None = None
    runs: int = 6
    minutes: float = 2.0
    seed: int = 0
    engine: EngineName = DEFAULT
    """Of the fresh runs' world."""
    rays: RaysName = DEFAULT_RAYS
    jobs: int | None = None

    @property
    def command(self) -> str:
        """What a user would type."""
        logs, healthy = ([one.typed for one in some] for some in (self.logs, self.healthy))
        words: list[object] = ["realitygap", "gain", *option("--log", logs)]
        words += ["--extended", self.extended.typed or ROBOT, *option("--effect", self.effects)]
        words += option("--healthy", healthy)
        words += ["--transfer", self.transfer] if self.transfer else []
        if self.effects:
            words += ["--runs", self.runs, "--minutes", f"{self.minutes:g}", "--seed", self.seed]
            words += ["--engine", self.engine] if self.engine != DEFAULT else []
            words += ["--rays", self.rays] if self.rays != DEFAULT_RAYS else []
        return typed(*words)

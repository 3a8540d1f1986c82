"""What is asked of a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass

from realitygap.studies.inputs.logs import Source
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.typed import option, typed


@dataclass(frozen=True, kw_only=True)
class Request:
    """What to diagnose and with what."""

    logs: tuple[Source, ...]
    model: Model
    reference: str | None = None
    seed: int = 0
    without: tuple[str, ...] = ()
    """Causes of the catalogue that are not to be tried."""

    @property
    def command(self) -> str:
        """What a user would type."""
        return typed(*self.words(), *self.also())

    def words(self, *further: object) -> list[object]:
        """The command, its logs, with further ones behind them, model and reference."""
        words: list[object] = ["realitygap", "diagnose", *(one.typed for one in self.logs)]
        words += [*further, *(["--model", self.model.typed] if self.model.typed else [])]
        return words + (["--reference", self.reference] if self.reference else [])

    def also(self) -> list[object]:
        """Its seed and the causes to do without."""
        seed = ["--seed", self.seed] if self.seed else []
        return [*seed, *option("--without", self.without)]

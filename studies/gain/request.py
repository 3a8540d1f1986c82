"""What a gain is asked of, and the models compared: minimal, extended and perhaps the true one."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.tables import Tables
from realitygap.models.belief.modelfile import DEFAULT as ROBOT
from realitygap.models.belief.modelfile import ModelFile
from realitygap.reality.engine import DEFAULT, EngineName
from realitygap.reality.rays import DEFAULT_RAYS, RaysName
from realitygap.studies.gain.runs import BEFORE, EXTENDED, ORACLE
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


@dataclass(frozen=True)
class Compared:
    """An extended model and the minimal one it extends."""

    name: str
    """Of the extended model's file."""
    file: ModelFile
    plain: ModelFile
    tables: Tables | None

    def named(self, true: ModelFile | None) -> dict[str, ModelFile]:
        """By name; the minimal one first."""
        both = {BEFORE: self.plain, EXTENDED: self.file}
        return both if true is None else {**both, ORACLE: true}

    @property
    def robots(self) -> frozenset[int] | None:
        """Robots that the extension concerns; None: all."""
        causes = () if self.file.extension is None else self.file.extension.causes
        laws = () if self.file.extension is None else self.file.extension.laws
        every = [*(one.robots for one in causes), *(one.robots for one in laws)]
        if any(robots == "all" for robots in every):
            return None
        return frozenset(int(robot) for robots in every for robot in robots)

    def check_robots(self, known: Collection[int]) -> None:
        """Refuse an extension of robots that are in no run.

        Raises:
            InputError: it names such a robot.
        """
        if self.file.extension is not None:
            self.file.extension.check_robots(known, self.name)


def compared(extended: Model) -> Compared:
    """The models that an extended one is compared with.

    Raises:
        InputError: it extends nothing.
    """
    if extended.file.extension is None:
        expected = "a model with a table [extension], as of diagnose"
        raise InputError("--extended", extended.path or extended.label, expected)
    return Compared(extended.label, extended.file, extended.minimal().file, extended.tables)

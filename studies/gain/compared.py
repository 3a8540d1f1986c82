"""The models whose predictions are compared: minimal, extended and, where known, the true one."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.tables import Tables
from realitygap.models.belief.modelfile import ModelFile
from realitygap.studies.gain.runs import BEFORE, EXTENDED, ORACLE
from realitygap.studies.inputs.model import Model


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

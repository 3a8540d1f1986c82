"""The models whose predictions are compared: minimal, extended and, where known, the true one."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.tables import Tables
from realitygap.models.modelfile import ModelFile, find_model_file, read_model_file
from realitygap.models.tables import load_tables
from realitygap.studies.gain.runs import BEFORE, EXTENDED, ORACLE


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
        if any(cause.robots == "all" for cause in causes):
            return None
        return frozenset(int(robot) for cause in causes for robot in cause.robots)

    def check_robots(self, known: Collection[int]) -> None:
        """Refuse an extension of robots that are in no run.

        Raises:
            InputError: it names such a robot.
        """
        if self.file.extension is not None:
            self.file.extension.check_robots(known, self.name)


def read_compared(extended: str) -> Compared:
    """The models of an `extended.toml`.

    Raises:
        InputError: it cannot be read, or extends nothing.
    """
    path = find_model_file(extended)
    file = read_model_file(path)
    if file.extension is None:
        raise InputError("--extended", path, "a model with a table [extension], as of diagnose")
    tables = None if file.sensors is None else load_tables(path.parent / file.sensors.tables)
    return Compared(path.name, file, file.model_copy(update={"extension": None}), tables)

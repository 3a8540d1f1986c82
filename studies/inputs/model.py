"""A model as it is given: a file, a shipped robot, or one that a diagnosis has just made."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

import pandas as pd
from markupsafe import escape

from realitygap.embedded_sim import InputError, PointModel, Tables
from realitygap.models.belief.extended import NAME, extended_text, read_back
from realitygap.models.belief.extension import Extension
from realitygap.models.belief.law_words import equation, reading
from realitygap.models.belief.modelfile import DEFAULT, ModelFile, find_model_file, read_model_file
from realitygap.models.belief.tables import load_tables, tables_bytes
from realitygap.studies.pages.notebook import html_table, rows_table
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.provenance import file_read


@dataclass(frozen=True, eq=False, repr=False)
class Model:
    """What a simulator believes about one kind of robot, and the sensor tables it looks up.

    `Model.load` reads one. A diagnosis makes one (`extended`), which lies nowhere until it is
    written. Every function that takes a model also takes what `load` takes.
    """

    file: ModelFile
    """The content of the model file, in SI units."""
    tables: Tables | None = None
    """Captured; None: motion alone is modelled."""
    path: Path | None = None
    """Where the file lies; None: nowhere."""
    given: str | None = None
    """As it was asked for; None: nobody asked, or it lies nowhere."""

    @classmethod
    def load(cls, source: AnyModel = None) -> Model:
        """Read a model file with its sensor tables.

        Args:
            source: A path (.toml), the name of a shipped robot, or None: the e-puck. A model is
                taken as it is.

        Raises:
            InputError: there is no such file or robot, or it cannot be used.
        """
        if isinstance(source, Model):
            return source
        given = None if source is None else str(source)
        path = find_model_file(given)
        file = read_model_file(path)
        tables = None if file.sensors is None else load_tables(path.parent / file.sensors.tables)
        return cls(file, tables, path, given)

    @property
    def name(self) -> str:
        """What the file calls it."""
        return self.file.name

    @property
    def label(self) -> str:
        """Name of the file, for messages."""
        return (self.path or NAME).name

    @property
    def typed(self) -> str | None:
        """What a user would type for it; None: nothing, it is what is taken if nothing is said."""
        return str(NAME) if self.path is None else self.given

    @property
    def causes(self) -> pd.DataFrame:
        """What it has beyond the minimal model: a row per parameter of each cause.

        Columns `cause`, `word` (such as which wheel), `robots` ("all", or a tuple of numbers or
        names), `parameter`, `value`, `low`, `high` (95 % interval; NaN: none), `unit`.
        """
        causes = () if self.file.extension is None else self.file.extension.causes
        rows = [
            {
                "cause": cause.name,
                "word": cause.word,
                "robots": self._called(cause.robots),
                "parameter": name,
                **value.model_dump(include={"value", "low", "high", "unit"}),
            }
            for cause in causes
            for name, value in cause.parameters.items()
        ]
        columns = ["cause", "word", "robots", "parameter", "value", "low", "high", "unit"]
        return rows_table(rows, columns, ("value", "low", "high"))

    @property
    def laws(self) -> pd.DataFrame:
        """What it has beyond its causes: a row per amplitude of each law.

        Columns `law` (its number), `equation`, `latex` (both with `a` for the amplitude),
        `reading`, `channel`, `robot` (None: every one without its own), `value`, `low`, `high`
        (95 % interval; NaN: none), `unit`.
        """
        laws = () if self.file.extension is None else self.file.extension.laws
        names = (self.file.extension or Extension()).called
        rows = [
            {
                "law": number,
                "equation": equation(law.channel, law.atoms),
                "latex": equation(law.channel, law.atoms, latex=True),
                "reading": reading(law.channel, law.atoms, own.value, self.file.robot.wheel_radius),
                "channel": law.channel,
                "robot": None if own.robot is None else names.key(own.robot),
                **own.model_dump(include={"value", "low", "high"}),
                "unit": table.unit,
            }
            for number, table in enumerate(laws)
            for own in table.amplitudes
            for law in (table.law(own.value),)
        ]
        columns = ["law", "equation", "latex", "reading", "channel", "robot"]
        columns += ["value", "low", "high", "unit"]
        return rows_table(rows, columns, ("value", "low", "high"))

    def point(self, robot: int | None = None) -> PointModel:
        """The point model; of one robot, where the extension concerns some robots only."""
        return self.file.point_model(self.tables, robot=robot)

    def on_board(self, robots: int) -> list[PointModel]:
        """What each robot of a swarm believes.

        Raises:
            InputError: it has no sensors, or its extension names a robot that does not exist.
        """
        if self.tables is None:
            expected = 'a table [sensors] with tables = "..."'
            raise InputError(f"{self.label}: sensors", "nothing", expected)
        return self.file.of_robots(robots, self.tables, self.label)

    def extended(self, added: Extension) -> Model:
        """The model with causes beyond those it has, as whoever loads its file has it.

        Raises:
            InputError: the causes together are no model.
        """
        file = read_back(self._text(added))
        return replace(self, file=file, path=None, given=None)

    def minimal(self) -> Model:
        """The model without what it has been extended by."""
        return replace(self, file=self.file.model_copy(update={"extension": None}))

    def write(self, out: Path | str, *, force: bool = False) -> Model:
        """Write `extended.toml`, and the sensor tables beside it, into a new directory.

        Args:
            out: The directory.
            force: Replace what a former call has written.

        Returns:
            The model, which now lies there.

        Raises:
            InputError: `out` is there already or cannot be written.
        """
        with whole_directory(Path(out), force=force, holds=(str(NAME),)) as part:
            self.keep(part)
        return Model.load(Path(out) / NAME)

    def keep(self, folder: Path) -> None:
        """Write the same files into a directory that is there."""
        (folder / NAME).write_text(self._text(), encoding="utf-8")
        if self._beside is not None and self.tables is not None:
            (folder / self._beside).write_bytes(tables_bytes(self.tables))

    def entries(self, option: str = "--model") -> list[dict[str, str]]:
        """Of `inputs`: its file and its tables, by who asked for them.

        Raises:
            InputError: a file is no longer there.
        """
        sensors = f"{option}: sensors"
        if self.path is not None:
            entries = [file_read(option, self.path, self.given or DEFAULT)]
            if self.file.sensors is not None:
                tables = self.file.sensors.tables
                entries.append(file_read(sensors, self.path.parent / tables, str(tables)))
            return entries
        contents = [(option, str(NAME), self._text().encode())]
        if self._beside is not None and self.tables is not None:
            contents.append((sensors, self._beside, tables_bytes(self.tables)))
        return [
            {"option": who, "file": name, "sha256": hashlib.sha256(content).hexdigest()}
            for who, name, content in contents
        ]

    @property
    def digest(self) -> str:
        """SHA-256 over its file and its tables."""
        read = "".join(entry["sha256"] for entry in self.entries())
        return hashlib.sha256(read.encode()).hexdigest()

    def _called(self, robots: tuple[int, ...] | str) -> tuple[int | str, ...] | str:
        """Robots by name, where the log that they were named from has names."""
        names = (self.file.extension or Extension()).called
        return robots if isinstance(robots, str) else tuple(names.key(robot) for robot in robots)

    @property
    def _beside(self) -> str | None:
        """Name of the tables' file beside the model's."""
        return None if self.file.sensors is None else self.file.sensors.tables.name

    def _text(self, added: Extension | None = None) -> str:
        """The file's text with causes added, and the tables beside it."""
        if added is None:
            former = self.file.extension or Extension()
            return extended_text(self.minimal().file, former, self._beside)
        return extended_text(self.file, added, self._beside)

    def _repr_html_(self) -> str:
        return f"<div><p>{escape(repr(self))}</p>{html_table(self.causes)}</div>"

    def __repr__(self) -> str:
        where = "in memory" if self.path is None else str(self.path)
        causes = self.causes["cause"].unique().tolist()
        beyond = f", with {', '.join(causes)}" if causes else ""
        sensors = "motion alone" if self.tables is None else "motion and sensors"
        return f"<Model {self.name!r} ({where}): {sensors}{beyond}>"


AnyModel: TypeAlias = Model | Path | str | None
"""A model, or what `Model.load` takes."""

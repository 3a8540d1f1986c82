"""What a diagnosis hands over: tables, the extended model, and the files that tell it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from realitygap.models.log.preflight.entry import PreflightEntry
from realitygap.models.naming.channels.senses.joined import WholeExamination
from realitygap.models.naming.diagnosis import Verdict
from realitygap.studies.diagnosis.words import verdict_sentence
from realitygap.studies.inputs.logs import Log
from realitygap.studies.inputs.model import Model
from realitygap.studies.pages.notebook import Telling, WrittenResult, new_axes, rows_table
from realitygap.studies.plumbing.provenance import write_json

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILE = "diagnosis.json"
LAW = ("equation", "reading", "channel", "of", "shape")
"""Keys of a law that are told of each of its robots."""


@dataclass(frozen=True, eq=False, repr=False)
class DiagnosisResult(WrittenResult, Telling):
    """What is wrong with the robots of a log, and the model that knows of it."""

    holds = FILE

    content: Mapping[str, Any]
    """Of `diagnosis.json`."""
    extended: Model
    """The model with what was named; it loads wherever a model does."""
    command: str
    """The command line that would ask the same."""
    next_commands: tuple[str, ...]
    """What to type to tell rivals apart; empty: nothing is proposed."""
    examined: WholeExamination = field(repr=False)
    """What the diagnosis was drawn from."""
    log: Log = field(repr=False)
    """The log that was diagnosed."""

    @property
    def verdict(self) -> Verdict:
        """`named`, `nothing_wrong`, `cannot_tell`, `ambiguous` or `unexplained`."""
        return self.examined.diagnosis.verdict

    @property
    def sentence(self) -> str:
        """The verdict in words, with causes, robots and values."""
        return verdict_sentence(self.examined.diagnosis)

    @property
    def causes(self) -> pd.DataFrame:
        """What was found: a row per parameter of each cause.

        Columns `cause`, `word` (such as which wheel; empty: none), `robots` ("all" or a list of
        ids), `parameter`, `value`, `low`, `high` (95 % interval), `unit`, `distance` (standard
        deviations from health), `alternatives` (other causes that it could be), `exported`
        (whether the extended model has it) and `why` not.
        """
        columns = ["cause", "word", "robots", "parameter", "value", "low", "high", "unit"]
        columns += ["distance", "alternatives", "exported", "why"]
        rows = [row for one in self.content["causes"] for row in _rows(one)]
        return rows_table(rows, columns, ("value", "low", "high", "distance"))

    @property
    def detectable(self) -> pd.DataFrame:
        """What this log would have shown, a row per cause, in the robot that shows it worst.

        Columns `cause`, `parameter`, `unit`, `null` (value that changes nothing; NaN: infinite),
        `size` (departure from it that would have been seen; NaN: none), `robot` (None: the place).
        """
        rows = [{"cause": name, **one} for name, one in self.content["detectable"].items()]
        columns = ["cause", "parameter", "unit", "null", "size", "robot"]
        return rows_table(rows, columns, ("null", "size"))

    @property
    def gain(self) -> pd.DataFrame:
        """What the extended model predicts better, on parts of the log it was not fitted to.

        Columns `prediction` (such as `position_5s`), mean absolute errors `before` and `after`,
        `low`, `high` (95 % interval of `after`), `healthy` (of a healthy robot), `unit`.
        """
        rows = [{"prediction": name, **one} for name, one in self.content["gain"].items()]
        numbers = ("before", "after", "low", "high", "healthy")
        return rows_table(rows, ["prediction", *numbers, "unit"], numbers)

    @property
    def unexplained(self) -> pd.DataFrame:
        """Structure that no cause accounts for.

        Columns `channel`, `robots`, `quantity` that it follows, `share` of the squared error,
        `distance` (standard deviations from health), `where` in words.
        """
        columns = ["channel", "robots", "quantity", "share", "distance", "where"]
        return rows_table(self.content["unexplained"], columns, ("share", "distance"))

    @property
    def laws(self) -> pd.DataFrame:
        """Equations for what is unexplained, a row per robot of each law.

        Columns `equation`, `reading`, `channel`, `of` (what it follows), `shape` (False: shape not
        found, a curve), `robot` (missing: of no one quantity), `value`,
        `low`, `high` (its amplitude, 95 % interval), `unit`.
        """
        rows: list[dict[Hashable, Any]] = [
            {**{name: law[name] for name in LAW}, **one}
            for law in self.content.get("laws", ())
            for one in law["coefficients"] or [{}]
        ]
        columns = [*LAW, "robot", "value", "low", "high", "unit"]
        return rows_table(rows, columns, ("value", "low", "high"))

    @property
    def used(self) -> pd.DataFrame:
        """Shares of each robot's time that could be used, and why not the rest; `seconds` (s)."""
        return pd.DataFrame(self.content["log"]["robots"])

    @property
    def preflight(self) -> pd.DataFrame:
        """What the log can tell, a row per measured entry.

        Columns `name`, `meaning`, `value` (None: not told), `unit`, `low`, `high` (95 %),
        `follows` (`nothing`, `modelled`, `repaired`, `silences`), `why`, `causes` concerned.
        """
        columns = [one.name for one in fields(PreflightEntry)]
        return rows_table(self.content["log"]["preflight"], columns, ("low", "high"))

    def keep(self, folder: Path) -> None:
        """Write diagnosis.json, extended.toml and report.html into a directory that is there."""
        from realitygap.studies.diagnosis.report import Findings, write_report

        write_json(folder / FILE, dict(self.content))
        self.extended.keep(folder)
        shown = Findings(
            examined=self.examined,
            log=self.log.measured,
            extended=self.extended,
            command=self.command,
            following=self.next_commands,
        )
        write_report(shown, folder / "report.html")

    def table_told(self) -> pd.DataFrame:
        """As `Telling`: the causes."""
        columns = ["cause", "word", "robots", "parameter", "value", "low", "high", "unit"]
        return self.causes[[*columns, "exported"]]

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw where a robot was seen, where the model and the extended one said it would be.

        It is the stretch in which the model was furthest off, of the robots concerned.

        Args:
            axes: To draw into; new ones if absent.
        """
        from realitygap.studies.diagnosis.report import moved
        from realitygap.studies.diagnosis.tracks import draw_tracks, worst_tracks

        found = self.examined.diagnosis
        log, before = self.log.measured, self.examined.model
        seen = worst_tracks(log, before, self.extended.file, moved(found))
        if seen is None:  # no second of it is whole
            return self.log.plot(axes)
        axes = new_axes(axes)
        draw_tracks(seen, axes, enlarged=True)
        axes.set_title(f"robot {found.names[seen.robot]}, {seen.seconds:g} s")
        return axes

    def told(self) -> tuple[str, str, str]:
        return f"Diagnosis: {self.verdict}", self.sentence, ".causes .detectable .gain .extended"


def _rows(cause: Mapping[str, Any]) -> list[dict[Hashable, Any]]:
    """A cause's parameters; one without any has a row all the same."""
    numbers = {k: v for k, v in cause["parameters"].items() if v["unit"] != "word"}
    word = next((v["value"] for v in cause["parameters"].values() if v["unit"] == "word"), "")
    common = {
        "cause": cause["name"],
        "word": word,
        "robots": cause["robots"],
        "distance": cause["evidence"]["distance"],
        **{name: cause[name] for name in ("alternatives", "exported", "why")},
    }
    return [{**common, "parameter": name, **one} for name, one in numbers.items()] or [common]

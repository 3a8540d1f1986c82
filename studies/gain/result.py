"""What the measurement of a gain hands over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from realitygap.models.log.measured import write_table
from realitygap.studies.gain.runs import BEFORE, EXTENDED, HEALTHY, ORACLE
from realitygap.studies.pages.notebook import Telling, WrittenResult, new_axes
from realitygap.studies.plumbing.provenance import write_json

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILE = "gain.json"
ESTIMATES = (BEFORE, HEALTHY, EXTENDED, ORACLE, "reducible", "remains", "over_healthy", "closed")


@dataclass(frozen=True, eq=False, repr=False)
class GainResult(WrittenResult, Telling):
    """How much better an extended model predicts runs that nothing was named from."""

    holds = FILE

    content: Mapping[str, Any]
    """Of `gain.json`."""
    table: pd.DataFrame = field(repr=False)
    """Sums of absolute errors by run, robot, model, channel and block: of `errors.parquet`."""

    @property
    def summary(self) -> tuple[str, ...]:
        """What it is worth, in sentences."""
        return tuple(self.content["summary"])

    @property
    def errors(self) -> pd.DataFrame:
        """Mean absolute errors: a row per `kind`, `channel` and `horizon`.

        Columns `unit`, `number` of windows or readings, and of each estimate (`before`, `healthy`,
        `extended`, `oracle`, `reducible`, `remains`, `over_healthy`, `closed`) its value and the
        ends of its 95 % interval, as in `closed`, `closed_low`, `closed_high`; NaN: there is none.
        """
        names = ("kind", "channel", "horizon", "unit", "number")
        rows = [
            {name: one[name] for name in names}
            | {
                name if end == "value" else f"{name}_{end}": (one[name] or {}).get(end)
                for name in ESTIMATES
                for end in ("value", "low", "high")
            }
            for one in self.content["errors"]
        ]
        table = pd.DataFrame(rows)
        return table.astype({name: float for name in table if name not in names})

    @property
    def by_run(self) -> pd.DataFrame:
        """Mean errors of every run: `run`, `kind`, `channel`, `horizon`, `unit`, one per model."""
        return pd.DataFrame(self.content["by_run"])

    def keep(self, folder: Path) -> None:
        """Write gain.json, errors.parquet and report.html into a directory that is there."""
        from realitygap.studies.gain.report import write_report

        write_json(folder / FILE, dict(self.content))
        write_table(self.table, folder / "errors.parquet", {})
        write_report(self.content, folder / "report.html")

    def table_told(self) -> pd.DataFrame:
        """As `Telling`: the errors of every model."""
        models = [name for name in (BEFORE, HEALTHY, EXTENDED, ORACLE) if name in self.errors]
        return self.errors[["channel", "horizon", "unit", *models]].dropna(axis=1, how="all")

    def plot(self, axes: Axes | None = None, *, channel: str = "position") -> Axes:
        """Draw the error of every model against how far ahead is predicted.

        Args:
            axes: To draw into; new ones if absent.
            channel: position or heading.
        """
        from realitygap.studies.gain.report import draw_channel

        axes = new_axes(axes)
        draw_channel(self.content["errors"], channel, axes)
        axes.legend()
        return axes

    def told(self) -> tuple[str, str, str]:
        return "Gain", "\n".join(self.summary), ".errors .by_run .table"

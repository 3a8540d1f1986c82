"""Measure the gap: a log replayed through a model, and what of it is no noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from realitygap.models.gap import whole as replayed
from realitygap.models.log.measured import SAMPLES, write_table
from realitygap.studies.fitness_gap.generations import (
    CoevolutionGap,
    coevolution_gap,
    find_generations,
    read_generations,
)
from realitygap.studies.gap.figures import draw_coevolution, draw_figures, draw_horizon
from realitygap.studies.gap.page import write_report
from realitygap.studies.gap.report import SCHEMA, Tidy, describe, tidy_tables
from realitygap.studies.gap.words import fitness_line
from realitygap.studies.inputs.logs import AnyLog, Log, as_log
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.inputs.placed import placed
from realitygap.studies.pages.notebook import Telling, WrittenResult, new_axes
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.progress import unseen
from realitygap.studies.plumbing.provenance import file_read, versions, write_json

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILE = "gap.json"


@dataclass(frozen=True, eq=False, repr=False)
class GapResult(WrittenResult, Telling):
    """What a simulation gets wrong about a log."""

    holds = FILE

    content: Mapping[str, Any]
    """Of `gap.json`."""
    tidy: Mapping[str, Tidy] = field(repr=False)
    """The tables with their units."""
    draw: Callable[[Path], None] = field(repr=False)
    """Writes the figures into a directory."""

    @property
    def flagged(self) -> bool:
        """Whether anything beyond noise was found in motion or sensors."""
        return bool(self.content.get("flagged", False))

    @property
    def summary(self) -> tuple[str, ...]:
        """What departs from the model, in sentences, the largest first."""
        return tuple(self.content["summary"])

    @property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Every table that `write` writes, by name; columns and units are in docs/files.md."""
        return {name: one.frame for name, one in self.tidy.items()}

    @property
    def horizons(self) -> pd.DataFrame:
        """Error against horizon: a row per `horizon`, `run` and `robot`.

        Columns `seconds` (s), `windows`, and of `position` (m) and `heading` (rad) the `_median`
        and `_p95` of the absolute error and the `_noise` that the tracker alone would give.

        Raises:
            KeyError: nothing was replayed: the directory had generations alone.
        """
        return self.tidy["horizons"].frame

    @property
    def channels(self) -> pd.DataFrame:
        """How large each error is: a row per `kind`, `channel` and `horizon`.

        Columns `unit` of `rms`, `noise_rms` and `bias_value`; the shares `noise`, `bias` and
        `structured` of the squared error; `p`, the chance of such a structure without any cause.
        """
        names = ("kind", "channel", "horizon", "unit", "rms", "noise_rms", "bias_value", "p")
        rows = [
            {name: one[name] for name in names} | one["shares"]
            for one in self.content.get("channels", ())
        ]
        return pd.DataFrame(rows, columns=[*names, "noise", "bias", "structured"])

    def keep(self, folder: Path) -> None:
        """Write gap.json, tidy tables, figures and report.html into a directory that is there."""
        for name, one in self.tidy.items():
            write_table(one.frame, folder / f"{name}.parquet", one.units)
        self.draw(folder)
        write_json(folder / FILE, dict(self.content))
        write_report(self.content, folder)

    def table_told(self) -> pd.DataFrame | None:
        """As `Telling`: how large each error is."""
        return self.channels.drop(columns=["bias_value"]) if len(self.channels) else None

    def plot(self, axes: Axes | None = None, *, channel: str = "position") -> Axes:
        """Draw the error against how far ahead is predicted, beside that of noise alone.

        Args:
            axes: To draw into; new ones if absent.
            channel: position or heading.

        Raises:
            KeyError: nothing was replayed: the directory had generations alone.
        """
        axes = new_axes(axes)
        draw_horizon(self.horizons, channel, axes)
        return axes

    def told(self) -> tuple[str, str, str]:
        look = ".horizons .channels .tables" if "horizons" in self.tidy else ".tables"
        return "Gap", "\n".join(self.summary), look


def measure_gap(
    log: AnyLog,
    *,
    model: AnyModel = None,
    seed: int = 0,
    out: Path | str | None = None,
    force: bool = False,
    begin: Callable[[str], None] = unseen,
) -> GapResult:
    """Show what the simulation gets wrong: replay a measured log through the point model.

    Args:
        log: A measured log or several, as `read_log` takes them. A directory with
            generations.parquet (a run's or a study's) adds the gap between simulated and real
            fitness; without samples, that is all.
        model: What is believed; that of the log, or the e-puck, if absent.
        seed: Of the tests' random turns and deals.
        out: Directory to write everything into as well, as `write` does; claimed before any work.
        force: Replace a gap that is there.
        begin: Called with the name of each stage.

    Raises:
        InputError: the log or the model cannot be used, or `out` cannot.
        Diverged: a replay left the finite numbers.
    """
    holds = (FILE,)
    if not (isinstance(log, Log) and model is None):
        model = Model.load(model)  # refused before the log is read
    place = nullcontext() if out is None else whole_directory(Path(out), force=force, holds=holds)
    with place as part:
        folder = Path(log) if isinstance(log, str | Path) else None
        generations = None if folder is None else find_generations(folder)
        inputs, evolved = [], None
        if generations is not None:
            begin("fitness in simulation and reality")
            evolved = coevolution_gap(read_generations(generations))
            inputs.append(file_read("LOG", generations))
        if folder is not None and evolved is not None and not (folder / SAMPLES).exists():
            found = _of_fitness(evolved, [*inputs, *Model.load(model).entries()])
        else:
            found = _of_log(log, model, seed, evolved, inputs, begin)
        if part is not None:
            begin("writing tables and figures")
            found.keep(part)
    return found


def _of_fitness(evolved: CoevolutionGap, inputs: list[dict[str, str]]) -> GapResult:
    """Of a directory that has generations but no samples: the gap in fitness alone."""
    content = {"schema": SCHEMA, "coevolution": evolved.report, "summary": [fitness_line(evolved)]}
    content |= {"inputs": inputs, "versions": versions()}
    tidy = {"coevolution": Tidy(evolved.table, evolved.units)}
    return GapResult(content, tidy, partial(draw_coevolution, evolved))


def _of_log(
    log: AnyLog,
    model: AnyModel,
    seed: int,
    evolved: CoevolutionGap | None,
    inputs: list[dict[str, str]],
    begin: Callable[[str], None],
) -> GapResult:
    """Of a log, and of the fitness of its run's generations where it has any."""
    begin("reading the log")
    read = as_log(log, model)
    believed = read.model
    measured = placed(read.measured, believed.file, believed.tables)
    inputs = [*(one.entry("LOG") for one in read.sources), *inputs, *believed.entries()]
    begin("replaying it and judging what is left")
    found = replayed.measure_gap(
        measured, believed.file, believed.point(), seed=seed, name=believed.label
    )
    content = describe(measured, found, name=believed.name, coevolution=evolved)
    tidy = tidy_tables(measured, found)
    if evolved is not None:
        tidy["coevolution"] = Tidy(evolved.table, evolved.units)
    return GapResult(
        content | {"inputs": inputs, "versions": versions()},
        tidy,
        partial(draw_figures, measured, found, coevolution=evolved),
    )

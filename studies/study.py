"""Whole studies: many runs on every core or on a cluster, resumed where they stopped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, rays_name
from realitygap.studies.pages.notebook import Telling, new_axes
from realitygap.studies.paper import study as whole
from realitygap.studies.paper.conditions import study_config
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.run.settings import run_config
from realitygap.studies.transfer import study as transferred
from realitygap.studies.transfer.alterations import chosen
from realitygap.studies.transfer.plan import transfer_config

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PER_MINUTE = "items per minute"
"""Unit of food in a study of transfer."""


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult(Telling):
    """A finished study: its tables are read when they are asked for."""

    path: Path
    """The study's directory, with report.html."""
    outcome: str
    """What came out, in a line."""

    @property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Every table of the study by the name of its file, such as `claims`."""
        tables = {p.stem: pd.read_parquet(p) for p in sorted(self.path.glob("*.parquet"))}
        return tables | {p.stem: pd.read_csv(p) for p in sorted(self.path.glob("*.csv"))}

    @property
    def food(self) -> pd.DataFrame:
        """Food of every run: `what` was run, `food`, and its `unit`."""
        tables = self.tables
        if "runs" in tables:
            runs = tables["runs"]
            what, food, unit = runs["alteration"] + ", " + runs["model"], runs["food"], PER_MINUTE
        else:
            runs = tables["study"]
            what, food, unit = runs["condition"], runs["food_total"], "items in a run"
            other = runs["variant"] != "default"
            what = what.where(~other, what + ", " + runs["variant"])
        return pd.DataFrame({"what": what, "food": food, "unit": unit})

    def table_told(self) -> pd.DataFrame:
        """As `Telling`: food by what was run."""
        by_what = self.food.groupby(["what", "unit"], sort=False)["food"]
        return by_what.agg(["count", "mean", "min", "max"]).reset_index()

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the food of every run, and its means.

        Args:
            axes: To draw into; new ones if absent.
        """
        axes, food = new_axes(axes), self.food
        means = food.groupby("what", sort=False)["food"].mean()
        axes.barh(list(means.index), means, color="#b9c4cf")
        axes.plot(food["food"], food["what"], ".", color="#1f77b4")
        axes.set(xlabel=f"food ({food['unit'].iloc[0]})")
        axes.invert_yaxis()
        return axes

    def told(self) -> tuple[str, str, str]:
        return f"Study ({self.path})", self.outcome, f".tables and {self.path / 'report.html'}"


def paper(
    out: Path | str,
    *,
    runs: int = 10,
    until_decided: bool = False,
    minutes: float = 60.0,
    robots: int = 10,
    seed: int = 0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    model: Path | str | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    quiet: bool = True,
) -> StudyResult:
    """Repeat section IV of the paper: its conditions and figures, and every claim tested.

    Args:
        out: The study's directory; an unfinished one is resumed.
        runs: Of each of the eleven conditions.
        until_decided: Add as many wherever a claim is open, up to 60 of a condition; then decide
            the claims in other readings, without selection, and with other lamps.
        minutes: Simulated, of each run.
        robots: In a run.
        seed: Everything random follows from it.
        engine: Physics of the world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        model: File on board; the e-puck if absent.
        jobs: Processes; all cores if absent.
        scheduler: Address of a Dask scheduler whose workers have this program.
        quiet: Otherwise how far it has come is told on standard error.

    Raises:
        InputError: a value cannot be used, `out` cannot, or the scheduler does not answer.
        Unfinished: some runs failed; the same call goes on with those that are missing.
    """
    on_board = None if model is None else str(model)
    asked: dict[str, Any] = {"runs": runs, "minutes": minutes, "robots": robots, "seed": seed}
    asked |= {"model": on_board, "engine": engine_name(engine), "rays": rays_name(rays)}
    asked["until_decided"] = until_decided
    return _studied("paper", asked, Path(out), Workers.chosen(jobs, scheduler), quiet)


def readings(
    out: Path | str,
    *,
    runs: int = 4,
    minutes: float = 30.0,
    robots: int = 10,
    seed: int = 0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    jobs: int | None = None,
    scheduler: str | None = None,
    quiet: bool = True,
) -> StudyResult:
    """Read the paper otherwise: which claims depend on the reading, on the lamp, on selection.

    Arguments and errors are those of `paper`; `runs` is of each condition and variant.
    """
    asked: dict[str, Any] = {"runs": runs, "minutes": minutes, "robots": robots, "seed": seed}
    asked |= {"engine": engine_name(engine), "rays": rays_name(rays)}
    return _studied("readings", asked, Path(out), Workers.chosen(jobs, scheduler), quiet)


def transfer(
    out: Path | str,
    *,
    effects: Sequence[str] = (),
    case: str = "light-at-nest",
    extended: Path | str | None = None,
    runs: int = 10,
    bars: int = 3,
    minutes: float = 20.0,
    trials: int = 16,
    genome: str = "paper",
    robots: int = 10,
    seed: int = 0,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    jobs: int | None = None,
    scheduler: str | None = None,
    quiet: bool = True,
) -> StudyResult:
    """Co-evolve in altered reality with the minimal, the extended and the oracle model on board.

    Args:
        out: The study's directory; an unfinished one is resumed.
        effects: Names of alterations (docs/transfer.md), or SPECs; all alterations if absent.
        case: Light under which SPECs are tried.
        extended: Extended model on board; diagnosed from a recorded log if absent.
        runs: Paired runs of each model.
        bars: Runs of each fixed controller.
        minutes: Simulated, of each run.
        trials: Embedded trials per genome.
        genome: paper or continuous.
        robots: In a run.
        seed: Everything random follows from it.
        engine: Physics of the world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        jobs: Processes; all cores if absent.
        scheduler: Address of a Dask scheduler whose workers have this program.
        quiet: Otherwise how far it has come is told on standard error.

    Raises:
        InputError: a value cannot be used, `out` cannot, or the scheduler does not answer.
        Unfinished: some runs failed; the same call goes on with those that are missing.
    """
    checked = run_config(case=case, robots=robots, genome=genome)
    config = transfer_config(
        alterations=chosen(tuple(effects), checked.case, robots),
        runs=runs,
        bars=bars,
        minutes=minutes,
        robots=robots,
        seed=seed,
        trials=trials,
        genome=genome,
        engine=engine_name(engine),
        rays=rays_name(rays),
        extended=None if extended is None else str(extended),
    )
    target, workers = Path(out), Workers.chosen(jobs, scheduler)
    return StudyResult(target, transferred.run_transfer(config, target, workers, quiet=quiet))


def _studied(
    name: str, asked: dict[str, Any], out: Path, workers: Workers, quiet: bool
) -> StudyResult:
    """Run what is missing, then write the tables and the report."""
    config = study_config(study=name, **asked)
    return StudyResult(out, whole.run_study(config, out, workers, quiet=quiet))

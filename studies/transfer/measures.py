"""What is measured of each run: food, fitness in simulation and reality, beliefs, adaptation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.studies.fitness_gap.generations import whole
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.run.experiment import HALVES
from realitygap.studies.transfer.plan import MODELS, TransferConfig, TransferRun

METRICS = {
    "food": "items per minute",
    "fitness_real": "s",
    "gap": "s",
    "right_third": "share",
    "minutes_to_adapt": "min",
}
"""What is compared, and its unit. More is better of food, F_R and the right third."""
WINDOW = 3
"""min over which food is averaged when asking whether a swarm has adapted; our choice."""
ADAPTED = 0.75
"""Share of the best fixed controller's food at which a swarm has adapted; our choice."""


def collect(directory: StudyDirectory[TransferConfig, TransferRun]) -> pd.DataFrame:
    """A row per run: what it was, items per minute, F_R, F_S, their gap, and beliefs."""
    rows, courses = [], []
    for run in directory.runs:
        path = directory.path(run)
        course = _course(run, path)
        rows.append({**_who(run), "food": float(course.mean()), **_fitness(run, path)})
        courses.append(course)
    table = pd.DataFrame(rows)
    table["minutes_to_adapt"] = _minutes_to_adapt(table, courses)
    return table


def _who(run: TransferRun) -> dict[str, Any]:
    return {
        "alteration": run.alteration.name,
        "model": run.controller,
        "index": run.index,
        "seed": run.config.seed,
    }


def _course(run: TransferRun, path: Path) -> npt.NDArray[np.float64]:
    """Items per minute in each minute of a run."""
    t = pd.read_parquet(path / "deposits.parquet", columns=["t"])["t"].to_numpy() / 60.0
    edges = np.append(np.arange(0.0, run.config.minutes), run.config.minutes)
    return np.histogram(t, bins=edges)[0] / np.diff(edges)


def _fitness(run: TransferRun, path: Path) -> dict[str, float]:
    """Means over the whole generations of all robots; NaN without evolution."""
    table = pd.read_parquet(path / "generations.parquet")
    table = table[whole(table)]
    third = pd.to_numeric(table["s0_third"], errors="coerce").astype(float)
    right = (third == HALVES[run.config.case][0]).where(third.notna())
    return {
        "fitness_real": float(table["fitness_real"].mean()),
        "fitness_sim": float(table["fitness_sim"].mean()),
        "gap": float((table["fitness_sim"] - table["fitness_real"]).mean()),
        "right_third": float(right.astype(float).mean()),
    }


def _minutes_to_adapt(table: pd.DataFrame, courses: list[npt.NDArray[np.float64]]) -> list[float]:
    """First minute from which three bring 3/4 of the bar's food; a run's length if none does."""
    minutes = []
    for row, course in zip(table.itertuples(), courses, strict=True):
        goal = ADAPTED * bar(table, str(row.alteration))[1]
        if row.model not in MODELS or np.isnan(goal) or len(course) < WINDOW:
            minutes.append(np.nan)
            continue
        smooth = np.convolve(course, np.full(WINDOW, 1.0 / WINDOW), mode="valid")
        reached = np.flatnonzero(smooth >= goal)
        minutes.append(float(reached[0] if len(reached) else len(course)))
    return minutes


def bar(table: pd.DataFrame, alteration: str) -> tuple[str, float]:
    """The fixed controller that brings most food there, and its items per minute; NaN: none ran."""
    there = table[(table["alteration"] == alteration) & ~table["model"].isin(MODELS)]
    if there.empty:
        return "", float("nan")
    means = there.groupby("model")["food"].mean()
    return str(means.idxmax()), float(means.max())

"""What is measured of each run, and what each model would pick among nine controllers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import SCENARIOS, Behaviour, PointModel, evaluate
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


THIRDS = (0.165, 0.495, 0.825)
"""A gene in the middle of each third."""
WORDS = ("away", "search", "towards")
"""What a third of G0 or G1 selects (paper, Fig. 4)."""
GENOMES = tuple(product(THIRDS, THIRDS))
NAMES = tuple(f"{food} / {empty}" for food, empty in product(WORDS, WORDS))
"""With food / without."""
TRIALS = 200
"""Per controller: the mean's noise is below 2 s; our choice."""

Table = npt.NDArray[np.float64]


def earnings(models: Sequence[PointModel], seed: int) -> Table:
    """What the nine controllers earn in simulation under each scenario, mean over robots' models.

    Returns:
        (3, 9) s of fitness.
    """
    distinct = {id(model): model for model in models}
    random = np.random.default_rng(np.random.SeedSequence(seed))
    words = np.tile(random.integers(0, 2**32, (TRIALS, 4), dtype=np.uint32), (9, 1))
    total = np.zeros((len(SCENARIOS), len(GENOMES)))
    for key, model in distinct.items():
        share = sum(id(m) == key for m in models) / len(models)
        for scenario in range(len(SCENARIOS)):
            earned = evaluate(
                np.repeat(GENOMES, TRIALS, axis=0),
                np.full(len(GENOMES) * TRIALS, scenario),
                words,
                model=model,
                behaviour=Behaviour(),
            ).fitness
            total[scenario] += share * earned.reshape(len(GENOMES), TRIALS).mean(axis=1)
    return total


def choices(believed: Mapping[str, Table], scenario: int) -> list[dict[str, Any]]:
    """What each model's simulator picks under each scenario, and what that truly earns.

    Args:
        believed: `earnings` by model; the `oracle` is taken for the truth.
        scenario: The one that is set up.
    """
    true = believed["oracle"][scenario]
    return [
        {
            "model": name,
            "scenario": SCENARIOS[k],
            "right": k == scenario,
            "pick": NAMES[int(earned[k].argmax())],
            "believed": float(earned[k].max()),
            "true": float(true[int(earned[k].argmax())]),
            "best": float(true.max()),
        }
        for name, earned in believed.items()
        for k in range(len(SCENARIOS))
    ]

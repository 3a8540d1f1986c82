"""The study's tables: one tidy row per run, and every run's generations and deposits.

A run's halves are before and after the lamp may move; its quarters are q1 to q4. Deposits count
where they happen; a generation counts where its middle lies.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import SCENARIOS
from realitygap.embedded_sim.breeding import third
from realitygap.studies.paper.conditions import PlannedRun, StudyConfig
from realitygap.studies.paper.directory import StudyDirectory

HALVES = ("first", "second")
QUARTERS = ("q1", "q2", "q3", "q4")
BEHAVIOURS = ("negative", "search", "positive")
"""What a third of G0 or G1 selects (paper, Fig. 4)."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class StudyTables:
    """What every figure and claim is made from."""

    runs: pd.DataFrame
    """A row per run: `study.parquet`."""
    generations: pd.DataFrame
    """A row per run, robot and generation: `generations.parquet`."""
    minutes: float
    """Length of a run."""

    def values(self, condition: str, column: str, variant: str = "default") -> Array:
        """A column of one condition, a value per run, in the order of the runs."""
        rows = self.runs[(self.runs["condition"] == condition) & (self.runs["variant"] == variant)]
        return rows[column].to_numpy(dtype=np.float64)


def collect(directory: StudyDirectory[StudyConfig, PlannedRun]) -> StudyTables:
    """Read every run of a finished study."""
    rows, generations = [], []
    for run in directory.runs:
        path = directory.path(run)
        evolved = _generations(run, path)
        rows.append({**_who(run), **_food(run, path), **_genes(run, evolved)})
        generations.append(evolved)
    return StudyTables(
        runs=pd.DataFrame(rows),
        generations=pd.concat(generations, ignore_index=True),
        minutes=directory.study.minutes,
    )


def _who(run: PlannedRun) -> dict[str, Any]:
    condition = run.condition
    return {
        "condition": condition.name,
        "label": condition.label,
        "variant": condition.variant,
        "case": condition.case,
        "controller": condition.controller,
        "run": run.index,
        "seed": run.config.seed,
        "minutes": run.config.minutes,
        "robots": run.config.robots,
    }


def _generations(run: PlannedRun, path: Path) -> pd.DataFrame:
    """A run's generations with what run they are of and what the genes select."""
    table = pd.read_parquet(path / "generations.parquet")
    who = _who(run)
    for at, name in enumerate(("condition", "variant")):
        table.insert(at, name, who[name])
    table.insert(2, "index", run.index)
    for gene in ("g0", "g1"):
        table[f"{gene}_third"] = np.array([third(g) for g in table[gene]], dtype=np.int8)
    table["minute"] = (table["t_start"] + table["t_end"]) / 120.0
    return table


def _food(run: PlannedRun, path: Path) -> dict[str, Any]:
    """Items brought to the nest, and how long they took."""
    deposits = pd.read_parquet(path / "deposits.parquet")
    end = run.config.minutes * 60.0
    half = np.minimum(deposits["t"] / end * 2.0, 1.999).astype(int)
    quarter = np.minimum(deposits["t"] / end * 4.0, 3.999).astype(int)
    carried = deposits["t"] - deposits["t_pickup"]
    row: dict[str, Any] = {"food_total": len(deposits)}
    for at, name in enumerate(HALVES):
        row[f"food_{name}"] = int((half == at).sum())
    for at, name in enumerate(QUARTERS):
        row[f"food_{name}"] = int((quarter == at).sum())
    total = row["food_total"]
    row["share_first"] = row["food_first"] / total if total else np.nan
    row["imbalance"] = abs(row["share_first"] - 0.5)
    row["retrieval_total"] = carried.mean()
    for at, name in enumerate(HALVES):
        row[f"retrieval_{name}"] = carried[half == at].mean()
    for name in HALVES:
        items = row[f"food_{name}"]
        row[f"interval_{name}"] = end / 2.0 / items if items else np.nan
    return row


def _genes(run: PlannedRun, generations: pd.DataFrame) -> dict[str, Any]:
    """What the robots believed, how they were controlled, and whom they heard."""
    if run.condition.controller != "coevolution":
        return {}
    part = np.minimum(generations["minute"] / run.config.minutes * 4.0, 3.999).astype(int)
    means = swarm_mean(generations)
    mean_part = np.minimum((means.index + 0.5) / run.config.minutes * 4.0, 3.999).astype(int)
    row: dict[str, Any] = {}
    for at, quarter in enumerate(QUARTERS):
        within = generations[part == at]
        belief = within["s0_third"].to_numpy(dtype=np.float64)
        mean = np.array([third(s0) for s0 in means[mean_part == at]])
        for number, scenario in enumerate(SCENARIOS):
            row[f"robots_{scenario}_{quarter}"] = _share(belief == number)
            row[f"mean_{scenario}_{quarter}"] = _share(mean == number)
        for number, behaviour in enumerate(BEHAVIOURS):
            row[f"g0_{behaviour}_{quarter}"] = _share(within["g0_third"].to_numpy() == number)
    after = generations[part == 2]
    heard = [after.loc[after["g0_third"] == which, "heard"].mean() for which in (2, 0)]
    row["heard_positive_minus_negative"] = heard[0] - heard[1]
    return row


def swarm_mean(generations: pd.DataFrame) -> pd.Series[float]:
    """Mean S0 of one run's swarm in every minute."""
    return generations["s0"].groupby(generations["minute"].astype(int)).mean()


def _share(which: npt.NDArray[np.bool_]) -> float:
    return float(which.mean()) if which.size else float("nan")

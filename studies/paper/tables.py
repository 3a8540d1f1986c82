"""The study's tables: one tidy row per run, and every run's generations and deposits.

A run's halves are before and after the lamp may move; its quarters are q1 to q4. Deposits count
where they happen; a generation counts where its middle lies.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from realitygap.embedded_sim import SCENARIOS
from realitygap.embedded_sim.breeding import third
from realitygap.reality.arena import ForagingArena
from realitygap.studies.paper.conditions import PlannedRun, StudyConfig
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.run.experiment import HALVES, RunConfig

PARTS = ("first", "second")
QUARTERS = ("q1", "q2", "q3", "q4")
BEHAVIOURS = ("negative", "search", "positive")
"""What a third of G0 or G1 selects (paper, Fig. 4)."""

NEAR = 0.2
"""m, between centres: within it a robot has company; three of its diameters."""
TOUCH = 0.08
"""m, between centres: nearly a robot's diameter and 1 cm, the least that two keep who avoid."""

Array = npt.NDArray[np.float64]
Known = dict[str, tuple[dict[str, Any], pd.DataFrame]]
"""A run's row and its generations, by its name."""


@dataclass(frozen=True)
class StudyTables:
    """What every figure and claim is made from."""

    runs: pd.DataFrame
    """A row per run: `study.parquet`."""
    generations: pd.DataFrame
    """A row per run, robot and generation: `generations.parquet`."""
    minutes: float
    """Length of a run."""

    def first(self, runs: int) -> StudyTables:
        """Of the first so many runs of every condition."""
        return replace(
            self,
            runs=self.runs[self.runs["run"] < runs],
            generations=self.generations[self.generations["index"] < runs],
        )

    def whole(self, key: str) -> int:
        """Runs of a condition that are there, one after another from the first."""
        there = set(_of(self.runs, key)["run"])
        return next(at for at in itertools.count() if at not in there)

    def values(self, key: str, column: str) -> Array:
        """A column of one condition, a value per run, in the order of the runs.

        Args:
            key: Of the condition: its name, after its variant and a dot unless that is the default.
            column: Of `runs`.
        """
        return _of(self.runs, key)[column].to_numpy(dtype=np.float64)

    def curves(self, key: str, column: str) -> Array:
        """Mean of a column over the generations whose middle lies in a minute: (runs, minutes)."""
        rows = _of(self.generations, key)
        minutes = max(1, round(self.minutes))
        minute = np.minimum(rows["minute"].astype(int), minutes - 1)
        found = rows[column].groupby([rows["index"], minute]).mean().unstack(level=1)
        whole = found.reindex(columns=range(minutes)).ffill(axis=1).bfill(axis=1)
        return whole.to_numpy(dtype=np.float64)


def _of(table: pd.DataFrame, key: str) -> pd.DataFrame:
    """Rows of a condition, by its key."""
    variant, _, condition = key.rpartition(".")
    return table[(table["condition"] == condition) & (table["variant"] == (variant or "default"))]


def collect(
    directory: StudyDirectory[StudyConfig, PlannedRun], known: Known | None = None
) -> StudyTables:
    """Read every run of a study.

    Args:
        directory: The study's, its runs finished.
        known: Rows of runs that were read before, by name; grows.
    """
    known = {} if known is None else known
    for run in directory.runs:
        if run.name not in known:
            path = directory.path(run)
            evolved = _generations(run, path)
            places = pd.read_parquet(path / "positions.parquet")
            row = {**_who(run), **_food(run, path), **_genes(run, evolved)}
            known[run.name] = {**row, **company(places, evolved, run.config)}, evolved
    rows, generations = zip(*(known[run.name] for run in directory.runs), strict=True)
    return StudyTables(
        runs=pd.DataFrame(list(rows)),
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
    for at, name in enumerate(PARTS):
        row[f"food_{name}"] = int((half == at).sum())
    for at, name in enumerate(QUARTERS):
        row[f"food_{name}"] = int((quarter == at).sum())
    total = row["food_total"]
    row["share_first"] = row["food_first"] / total if total else np.nan
    row["imbalance"] = abs(row["share_first"] - 0.5)
    row["retrieval_total"] = carried.mean()
    for at, name in enumerate(PARTS):
        row[f"retrieval_{name}"] = carried[half == at].mean()
    for name in PARTS:
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
    truth, late = HALVES[run.config.case][1], generations[part >= 2]
    right = late["s0_third"] == truth
    for name, which in (("right", right), ("wrong", ~right)):
        row[f"earned_{name}"] = float(late.loc[which, "fitness_real"].mean())
    return row


def company(places: pd.DataFrame, generations: pd.DataFrame, run: RunConfig) -> dict[str, float]:
    """Who is near whom, from measured positions once a second.

    Args:
        places: `positions.parquet` of a run.
        generations: Of the same run, with `g0_third`.
        run: What was run.

    Returns:
        crowd_nest: robots in the nest, mean over the second half.
        touching: share of robots' seconds with another one within `TOUCH`.
        near_positive, near_negative: others within `NEAR` in the third quarter, of robots that
        carry food towards the light and away from it; NaN where there are none.
    """
    robots = run.robots
    xy = places[["x", "y"]].to_numpy(dtype=np.float64).reshape(-1, robots, 2)
    seconds = places["t"].to_numpy(dtype=np.float64).reshape(-1, robots)[:, 0]
    apart = np.linalg.norm(xy[:, :, None] - xy[:, None], axis=-1)
    apart[:, np.arange(robots), np.arange(robots)] = np.inf
    near, end = (apart < NEAR).sum(axis=2), run.minutes * 60.0
    *nest, radius = ForagingArena(run.arena_radius).nest
    at_nest = np.linalg.norm(xy - nest, axis=-1) < radius
    row = {
        "crowd_nest": float(at_nest[seconds >= end / 2.0].sum(axis=1).mean()),
        "touching": float((apart < TOUCH).any(axis=2).mean()),
    }
    third_of = _running(generations, seconds, robots)
    after = (seconds >= end / 2.0) & (seconds < end * 0.75)
    for name, which in (("near_positive", 2), ("near_negative", 0)):
        of_kind = (third_of == which) & after[:, None]
        row[name] = float(near[of_kind].mean()) if of_kind.any() else np.nan
    return row


def _running(generations: pd.DataFrame, seconds: Array, robots: int) -> npt.NDArray[np.int8]:
    """(seconds, robots) third of the G0 that runs on each robot; -1 before it is switched on."""
    running = np.empty((len(seconds), robots), dtype=np.int8)
    for robot in range(robots):
        rows = generations[generations["robot"] == robot]
        thirds = np.append(np.int8(-1), rows["g0_third"].to_numpy())
        running[:, robot] = thirds[np.searchsorted(rows["t_start"], seconds, side="right")]
    return running


def swarm_mean(generations: pd.DataFrame) -> pd.Series[float]:
    """Mean S0 of one run's swarm in every minute."""
    return generations["s0"].groupby(generations["minute"].astype(int)).mean()


def _share(which: npt.NDArray[np.bool_]) -> float:
    return float(which.mean()) if which.size else float("nan")

"""The gap in fitness by the third that S0 is in: the robot's model and the environment's.

A controller's fitness in the simulator that bred it (F_S) and in the following minute of reality
(F_R) differ. Where the simulator's environment gene lies in the third that matches the light, what
remains is the robot's model (and the winner's luck: the best of ten noisy trials is credited too
much); what is added where it lies in a wrong third is the environment's model.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from realitygap.studies.fitness_gap.generations import COLUMNS, scenario, whole

BOOTSTRAPS = 2000
INTERVAL = (0.025, 0.975)
"""Quantiles of a 95 % interval."""
ENOUGH_RUNS = 8
"""Runs that are resampled whole; with fewer, the robots of each run are."""
LEAST = 2
"""Clusters (robots of a run, or runs) needed for an interval."""


class CoevolutionGap(NamedTuple):
    """F_S - F_R, per robot and generation and in short."""

    table: pd.DataFrame
    """run, robot, generation, case, s0_third, matches, fitness_sim, fitness_real, gap (s)."""
    report: dict[str, Any]
    """What `gap.json` holds under `coevolution`."""

    @property
    def units(self) -> dict[str, str]:
        """Units of the table's columns."""
        return dict.fromkeys(("fitness_sim", "fitness_real", "gap"), "s")


def coevolution_gap(generations: pd.DataFrame, *, seed: int = 0) -> CoevolutionGap | None:
    """F_S - F_R split by whether S0's third matches the case; None without any bred controller.

    The mean gap is (right third) + share of wrong thirds * (wrong third - right third): the robot's
    model and the environment's model. Intervals resample whole runs, or, of few runs, their robots.

    Args:
        generations: Columns `COLUMNS`; rows without F_S, F_R or third (fixed controllers), cut
            short by the run's end, or in which the lamp moved, are left out and counted.
        seed: Of the resampling.
    """
    # a table of generations has no other time of the lamp's move: a run ends with the last of them
    half = generations.groupby("run", observed=True)["t_end"].transform("max") / 2
    truth = scenario(generations, half)
    third = pd.to_numeric(generations["s0_third"], errors="coerce").astype(float)
    sim = pd.to_numeric(generations["fitness_sim"], errors="coerce").astype(float)
    real = pd.to_numeric(generations["fitness_real"], errors="coerce").astype(float)
    table = generations[list(COLUMNS)].assign(
        s0_third=third,
        matches=third == truth,
        fitness_sim=sim,
        fitness_real=real,
        gap=sim - real,
    )
    usable = whole(generations) & truth.notna() & third.notna() & table["gap"].notna()
    left_out = int((~usable).sum())
    table = table[usable].reset_index(drop=True)
    if table.empty:
        return None
    report: dict[str, Any] = {"unit": "s", "rows": len(table), "rows_left_out": left_out}
    report |= _split(table, seed)
    report["by_case"] = {str(case): _split(part, seed) for case, part in table.groupby("case")}
    report["by_robot"] = [
        {"robot": int(part["robot"].iloc[0])} | _means(part) for _, part in table.groupby("robot")
    ]
    return CoevolutionGap(table, report)


def _split(table: pd.DataFrame, seed: int) -> dict[str, Any]:
    """Means, and the two parts of the gap with intervals."""
    several = table["run"].nunique() >= ENOUGH_RUNS
    cluster = table.groupby("run" if several else ["run", "robot"]).ngroup().to_numpy()
    clusters = int(cluster.max()) + 1
    right = table["matches"].to_numpy()
    gap = table["gap"].to_numpy()
    sums = np.column_stack(
        [np.bincount(cluster, w, clusters) for w in (right, gap * right, ~right, gap * ~right)]
    )
    overall = _parts(sums.sum(axis=0))
    result: dict[str, Any] = _means(table)
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    drawn = np.empty((0, 3))
    if clusters >= LEAST:
        weight = rng.multinomial(clusters, np.full(clusters, 1 / clusters), BOOTSTRAPS)
        drawn = np.apply_along_axis(_parts, 1, weight @ sums)
    for k, name in enumerate(("total", "robot_model", "environment_model")):
        known = drawn[np.isfinite(drawn[:, k]), k]
        low, high = np.quantile(known, INTERVAL) if len(known) else (np.nan, np.nan)
        result[name] = {"value": _plain(overall[k]), "low": _plain(low), "high": _plain(high)}
    return result


def _parts(sums: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Total, robot model and environment model from (n, sum) of right and of wrong thirds."""
    n_right, right, n_wrong, wrong = sums
    n = n_right + n_wrong
    robot = right / n_right if n_right else np.nan
    environment = n_wrong / n * (wrong / n_wrong - robot) if n_wrong else 0.0
    return np.array([(right + wrong) / n if n else np.nan, robot, environment])


def _means(table: pd.DataFrame) -> dict[str, Any]:
    """Plain means of a part of the table."""
    right = table["matches"]
    return {
        "generations": len(table),
        "share_right_third": float(right.mean()),
        "fitness_sim": float(table["fitness_sim"].mean()),
        "fitness_real": float(table["fitness_real"].mean()),
        "gap_right_third": _plain(table.loc[right, "gap"].mean()),
        "gap_wrong_third": _plain(table.loc[~right, "gap"].mean()),
    }


def _plain(value: float) -> float | None:
    """A number JSON can hold: None for an empty mean."""
    return float(value) if np.isfinite(value) else None

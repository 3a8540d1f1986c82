"""Which generations tell of the gap in fitness, under which light, and of what it is made.

F_S - F_R of a generation is split, exactly, into

- the winner's curse: F_S is the best of ten noisy trials; the deployed controller evaluated anew
  under the same scenario earns less;
- the wrong scenario: what the controller earns in simulation under the scenario its S0 names, less
  what it earns under the one that is true;
- model error: what it earns in simulation under the true scenario, less what it earned in reality:
  other robots, a trial that starts where the last one ended, sensors and motors.

Only the thirds of G0 and G1 matter to the controller, so there are nine controllers and three
scenarios, and evaluating anew is a table of 27 means.

By thirds of S0 the gap needs nothing but a run's generations. Where the simulator's environment
gene lies in the third that matches the light, what remains is the robot's model (and the winner's
luck); what is added where it lies in a wrong third is the environment's model.
"""

from __future__ import annotations

import itertools
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from realitygap.embedded_sim import CONTROL_STEP, Behaviour, InputError, PointModel, evaluate
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.onboard import GENERATION_STEPS
from realitygap.models import load_models
from realitygap.models.log.opened import parsing
from realitygap.models.log.table_files import read_parquet
from realitygap.studies.run.experiment import HALVES

COLUMNS = (
    *("run", "robot", "generation", "t_start", "t_end", "case"),
    *("s0_third", "fitness_sim", "fitness_real"),
)


WHOLE = ("robot", "generation")
NUMBERS = ("t_start", "t_end", "s0_third", "fitness_sim", "fitness_real")


def find_generations(source: Path) -> Path | None:
    """The `generations.parquet` of a run's or a study's directory, if there is one."""
    path = source / "generations.parquet"
    return path if os.path.exists(path) else None


def read_generations(path: Path) -> pd.DataFrame:
    """A table of generations.

    Raises:
        InputError: not such a table, columns are missing, or hold something else.
    """
    table = read_parquet(path, "a table of generations")
    missing = [name for name in COLUMNS if name not in table]
    if missing:
        raise InputError(str(path), f"no column {missing[0]}", f"columns {', '.join(COLUMNS)}")
    if table["run"].isna().any():
        raise InputError(str(path), "rows without a run", "a run in each row")
    with parsing(str(path), f"numbers in {', '.join((*WHOLE, *NUMBERS))}"):
        numbers = {name: pd.to_numeric(table[name]).astype(float) for name in NUMBERS}
        if any(np.isinf(column).any() for column in numbers.values()):
            raise InputError(str(path), "infinite values", "numbers")
        whole = {name: table[name].astype("int64") for name in WHOLE}
        return table.assign(run=table["run"].astype(str), **whole, **numbers)


def whole(generations: pd.DataFrame) -> pd.Series[bool]:
    """Which generations the end of the run did not cut short."""
    lived = generations["t_end"] - generations["t_start"]
    return lived > (GENERATION_STEPS - 1) * CONTROL_STEP


def scenario(generations: pd.DataFrame, half: float | pd.Series[float]) -> pd.Series[float]:
    """The scenario each generation lived under; NaN: unknown, or the lamp moved within it.

    Args:
        generations: With `case`, `t_start` and `t_end`.
        half: s, when the lamp moves where it does.
    """
    case = generations["case"].astype(str)
    first, second = (case.map({name: pair[k] for name, pair in HALVES.items()}) for k in (0, 1))
    before, after = generations["t_end"] <= half, generations["t_start"] >= half
    moved = first.where(before, second.where(after))
    return first.where(first == second, moved).astype(float)


TRIALS = 1000
"""Fresh trials per controller and scenario; our choice: a standard error of about 1 s."""
GENES = (0.1, 0.5, 0.9)
"""A gene in each third."""
PARTS = ("curse", "scenario", "model")
"""Columns of the gap's three parts."""


def fresh_fitness_of(model: str | None, robots: int, seed: int) -> FloatArray:
    """Mean fitness (s) by robot and as `fresh_fitness`: (robots, 3, 3, 3), or (1, 3, 3, 3) where
    all robots have the same model on board."""
    models = load_models(model, robots)
    alike = all(one is models[0] for one in models)
    return np.stack([fresh_fitness(seed, one) for one in models[: 1 if alike else None]])


def fresh_fitness(seed: int, model: PointModel) -> FloatArray:
    """Mean fitness (s) by third of G0, third of G1 and scenario: (3, 3, 3).

    Args:
        seed: The study's; the trials are none that a robot has seen.
        model: On board.
    """
    cells = list(itertools.product(range(3), range(3), range(3)))
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(len(cells),)))
    result = evaluate(
        np.repeat([(GENES[g0], GENES[g1]) for g0, g1, _ in cells], TRIALS, axis=0),
        np.repeat(np.array([light for *_, light in cells], dtype=np.int32), TRIALS),
        random.integers(0, 2**32, (len(cells) * TRIALS, 4), dtype=np.uint32),
        model=model,
        behaviour=Behaviour(),
    )
    mean: FloatArray = result.fitness.reshape(3, 3, 3, TRIALS).mean(axis=3)
    return mean


def decompose(generations: pd.DataFrame, fresh: FloatArray, minutes: float) -> pd.DataFrame:
    """The gap of every whole generation of co-evolution and its three parts, in s of fitness.

    Left out: generations that the end of the run cuts short, and those in which the lamp moves.

    Args:
        generations: With thirds of the genes.
        fresh: (3, 3, 3) of `fresh_fitness`, or (robots or 1, 3, 3, 3) of `fresh_fitness_of`.
        minutes: Length of a run.
    """
    lived_under = scenario(generations, minutes * 30.0)
    usable = whole(generations) & lived_under.notna() & generations["fitness_sim"].notna()
    rows = generations[usable].copy()
    truth = lived_under[usable].to_numpy(dtype=np.intp)
    g0, g1 = (rows[f"{gene}_third"].to_numpy(dtype=np.intp) for gene in ("g0", "g1"))
    believed = rows["s0_third"].to_numpy(dtype=np.intp)
    every = fresh.reshape(-1, *fresh.shape[-3:])
    robot = rows["robot"].to_numpy(dtype=np.intp) % len(every)
    anew, under_truth = every[robot, g0, g1, believed], every[robot, g0, g1, truth]
    rows["truth"] = truth
    rows["gap"] = rows["fitness_sim"] - rows["fitness_real"]
    rows["curse"] = rows["fitness_sim"] - anew
    rows["scenario"] = anew - under_truth
    rows["model"] = under_truth - rows["fitness_real"]
    return rows


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

"""The reality gap while it co-evolves: fitness promised in simulation less fitness in reality.

F_S - F_R of a generation is split, exactly, into

- the winner's curse: F_S is the best of ten noisy trials; the deployed controller evaluated anew
  under the same scenario earns less;
- the wrong scenario: what the controller earns in simulation under the scenario its S0 names, less
  what it earns under the one that is true;
- model error: what it earns in simulation under the true scenario, less what it earned in reality:
  other robots, a trial that starts where the last one ended, sensors and motors.

Only the thirds of G0 and G1 matter to the controller, so there are nine controllers and three
scenarios, and evaluating anew is a table of 27 means.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pandas as pd

from embedded_sim import SCENARIOS, Behaviour, PointModel, evaluate
from embedded_sim.model import CONTROL_STEP
from embedded_sim.onboard import GENERATION_STEPS
from models import load_model, load_models
from reality import constants as k
from reality.hardware import lamp_power
from studies.experiment import HALVES
from studies.paper.statistics import Array
from studies.paper.tables import BEHAVIOURS

TRIALS = 1000
"""Fresh trials per controller and scenario; our choice: a standard error of about 1 s."""
GENES = (0.1, 0.5, 0.9)
"""A gene in each third."""
PARTS = ("curse", "scenario", "model")


def fresh_fitness_of(model: str | None, robots: int, seed: int) -> Array:
    """Mean fitness (s) by robot and as `fresh_fitness`: (robots, 3, 3, 3), or (1, 3, 3, 3) where
    all robots have the same model on board."""
    models = load_models(model, robots)
    alike = all(one is models[0] for one in models)
    return np.stack([fresh_fitness(seed, model=one) for one in models[: 1 if alike else None]])


def fresh_fitness(
    seed: int, lamp_range: float | None = None, *, model: PointModel | None = None
) -> Array:
    """Mean fitness (s) by third of G0, third of G1 and scenario: (3, 3, 3).

    Args:
        seed: The study's; the trials are none that a robot has seen.
        lamp_range: m, if not the nominal lamp.
        model: On board; None: the nominal e-puck.
    """
    model = model or load_model(None)
    if lamp_range is not None:
        model = replace(model, lamp_gain=lamp_power(lamp_range) / k.LAMP_POWER)
    cells = list(itertools.product(range(3), range(3), range(3)))
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(len(cells),)))
    result = evaluate(
        np.repeat([(GENES[g0], GENES[g1]) for g0, g1, _ in cells], TRIALS, axis=0),
        np.repeat(np.array([scenario for *_, scenario in cells], dtype=np.int32), TRIALS),
        random.integers(0, 2**32, (len(cells) * TRIALS, 4), dtype=np.uint32),
        model=model,
        behaviour=Behaviour(),
    )
    mean: Array = result.fitness.reshape(3, 3, 3, TRIALS).mean(axis=3)
    return mean


def controllers_table(fresh: Array) -> pd.DataFrame:
    """`controllers.csv`: what each of the nine controllers earns in each simulated scenario."""
    rows = [
        {
            "carrying_food": BEHAVIOURS[g0],
            "without_food": BEHAVIOURS[g1],
            **{name: round(float(fresh[g0, g1, at]), 2) for at, name in enumerate(SCENARIOS)},
        }
        for g0, g1 in itertools.product(range(3), range(3))
    ]
    return pd.DataFrame(rows)


def decompose(generations: pd.DataFrame, fresh: Array, minutes: float) -> pd.DataFrame:
    """The gap of every whole generation of co-evolution and its three parts, in s of fitness.

    Left out: generations that the end of the run cuts short, and those in which the lamp moves.

    Args:
        generations: With thirds of the genes.
        fresh: (3, 3, 3) of `fresh_fitness`, or (robots or 1, 3, 3, 3) of `fresh_fitness_of`.
        minutes: Length of a run.
    """
    half = minutes * 30.0
    whole = generations["t_end"] - generations["t_start"] > (GENERATION_STEPS - 1) * CONTROL_STEP
    moved = generations["case"].map(lambda case: HALVES[case][0] != HALVES[case][1])
    across = moved & (generations["t_start"] < half) & (generations["t_end"] > half)
    rows = generations[whole & ~across & generations["fitness_sim"].notna()].copy()
    second = (rows["t_start"] >= half).to_numpy(dtype=np.intp)
    truths = np.array([HALVES[case] for case in rows["case"]], dtype=np.intp).reshape(-1, 2)
    truth = truths[np.arange(len(rows)), second]
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


def gap_table(gaps: pd.DataFrame) -> pd.DataFrame:
    """`gap.csv`: mean gap and parts by condition and by third of S0, runs weighing alike."""
    rows = []
    for thirds in (False, True):
        keys = ["variant", "condition", *(["s0_third"] if thirds else [])]
        runs = gaps.groupby([*keys, "index"], sort=False)
        means = runs[["fitness_sim", "fitness_real", "gap", *PARTS]].mean()
        table = means.groupby(level=keys, sort=False).mean().reset_index()
        table["generations"] = gaps.groupby(keys, sort=False).size().to_numpy()
        if not thirds:
            table["s0_third"] = pd.NA
        rows.append(table)
    table = pd.concat([part.astype({"s0_third": "Int8"}) for part in rows], ignore_index=True)
    table.insert(2, "believes", table.pop("s0_third").map(dict(enumerate(SCENARIOS))).fillna("any"))
    return table

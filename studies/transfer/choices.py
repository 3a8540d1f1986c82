"""Why a better model brings more food or does not: what each model would pick among nine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from realitygap.embedded_sim import SCENARIOS, Behaviour, PointModel, evaluate

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

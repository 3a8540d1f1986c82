"""The fixed optimal controllers pay where the paper says they do."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from scipy import stats

from realitygap.studies.run.experiment import RunConfig, simulate


def food(job: tuple[str, str, float, int]) -> float:
    case, controller, minutes, seed = job
    config = RunConfig(case=case, controller=controller, minutes=minutes, seed=seed, samples=False)
    with TemporaryDirectory() as out:
        return simulate(config, (), Path(out))["deposits"]


def interval(items: np.ndarray) -> tuple[float, float]:
    """95 % interval of the mean (Student's t)."""
    half = stats.t.ppf(0.975, len(items) - 1) * items.std(ddof=1) / np.sqrt(len(items))
    return float(items.mean() - half), float(items.mean() + half)


CASES = [
    ("light-at-nest", "positive-phototaxis"),
    ("light-opposite-nest", "negative-phototaxis"),
]


@pytest.mark.parametrize(
    ("case", "controller"), [CASES[0], pytest.param(*CASES[1], marks=pytest.mark.slow)]
)
def test_phototaxis_beats_search_where_the_lamp_makes_it_useful(case: str, controller: str) -> None:
    phototaxis = sum(food((case, controller, 4.0, seed)) for seed in (1, 2))
    search = sum(food((case, "search", 4.0, seed)) for seed in (1, 2))
    assert phototaxis > 1.3 * search


@pytest.mark.slow
@pytest.mark.parametrize(("case", "controller"), CASES)
def test_phototaxis_beats_search_over_ten_runs_of_twenty_minutes(
    case: str, controller: str
) -> None:
    """Non-overlapping 95 % intervals of the mean food per run."""
    jobs = [(case, c, 20.0, s) for c in (controller, "search") for s in range(100, 110)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        items = np.array(list(pool.map(food, jobs))).reshape(2, 10)
    assert interval(items[0])[0] > interval(items[1])[1], items

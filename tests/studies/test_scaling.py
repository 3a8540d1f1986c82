"""What is said of a run's cost follows from the costs measured."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pandas as pd
import pytest

from realitygap.studies.measure.scaling import cost, line
from realitygap.studies.run.experiment import RunConfig


def test_a_line_tells_start_up_from_the_cost_of_each() -> None:
    x = pd.Series([1.0, 2.0, 5.0, 10.0])
    assert line(x, 0.4 + 0.3 * x) == pytest.approx((0.4, 0.3, 0.0), abs=1e-12)
    assert line(x, 0.4 + 0.3 * x**2)[2] > 0.1


def test_a_run_costs_time_and_memory() -> None:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as fresh:  # memory is a process's
        row = fresh.submit(cost, RunConfig(robots=2, minutes=0.02, seed=1)).result()
    assert (row["robots"], row["minutes"]) == (2, 0.02)
    assert row["cpu_seconds"] > 0.0
    assert 50.0 < row["peak_mb"] < 2000.0

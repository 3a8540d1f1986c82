"""Who is near whom, from positions that are known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.reality import constants as k
from realitygap.studies.paper.tables import company
from realitygap.studies.run.experiment import RunConfig


def test_company_is_counted_around_each_kind_in_the_third_quarter_alone() -> None:
    """0 and 1 are neighbours, 2 stands in the nest, 3 alone; 0 and 3 carry towards the light."""
    x, y = np.array([0.0, 0.1, k.NEST[0], -0.4]), np.array([0.3, 0.3, 0.0, -0.3])
    seconds = np.arange(240.0)
    places = pd.DataFrame(
        {
            "t": np.repeat(seconds, 4),
            "robot": np.tile(np.arange(4), 240),
            "x": np.tile(x, 240),
            "y": np.tile(y, 240),
        }
    )
    late = (places["t"] >= 180.0) & (places["robot"] == 1)
    places.loc[late, "x"] = 0.05  # in the last quarter they touch
    generations = pd.DataFrame(
        {
            "robot": [0, 0, 1, 2, 3],
            "t_start": [10.0, 120.0, 0.0, 0.0, 0.0],
            "g0_third": [0, 2, 0, 1, 2],
        }
    )
    found = company(places, generations, RunConfig(minutes=4.0, robots=4))
    assert found["near_positive"] == pytest.approx(0.5)  # one of the two has a neighbour
    assert found["near_negative"] == pytest.approx(1.0)
    assert found["crowd_nest"] == pytest.approx(1.0)
    assert found["touching"] == pytest.approx(2 / 4 * 60 / 240)
    none = generations[generations["g0_third"] != 0]
    assert np.isnan(company(places, none, RunConfig(minutes=4.0, robots=4))["near_negative"])

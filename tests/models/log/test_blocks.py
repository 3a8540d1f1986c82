from __future__ import annotations

import numpy as np
import pytest

from realitygap.models.log.blocks import nth


@pytest.mark.parametrize("origin", [0.0, 1000.0, 1003.7, 1.7e9 / 64])
def test_lengths_of_time_are_counted_alike_wherever_time_begins(origin: float) -> None:
    """Every boundary of a fifth of a second falls on a row."""
    t = origin + 0.04 * np.arange(1000)
    assert (nth(t - t[0], 0.2) == np.arange(1000) // 5).all()


def test_a_moment_before_a_boundary_is_before_it() -> None:
    assert nth(np.array([0.999, 1.0, 1.001]), 1.0).tolist() == [0, 1, 1]

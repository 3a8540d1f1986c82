"""From fits to names: intervals, and rivals."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.embedded_sim.model import FloatArray
from realitygap.models.naming.engine.value import values
from realitygap.models.naming.rules import Rules
from realitygap.models.naming.verdict import _margin
from tests.models.toys import motion_term

BLOCKS = 10
RULES = Rules()


def test_a_95_per_cent_interval_is_as_wide_as_its_covariance_says() -> None:
    random = np.random.default_rng(3)
    truth, error = 0.7, 0.4
    held = 0
    for _ in range(2000):
        value = np.array([truth + error * random.normal()])
        (told,) = values(motion_term("a"), value, np.array([[error**2]]))
        held += told.low <= truth <= told.high
        assert told.low < told.value < told.high
    assert held / 2000 == pytest.approx(0.95, abs=0.015)


EVEN = np.ones(BLOCKS) / BLOCKS
UNEVEN = np.array([0.5, 0.5, *[0.0] * (BLOCKS - 2)])
"""Shares of a whole, by block."""


def worse(lost: FloatArray, gain: float) -> bool:
    """Whether a rival is called worse by a (blocks,) deviance; `gain` is the cause's own."""
    return bool(lost.sum() > _margin(lost, gain, RULES))


def test_a_rival_is_worse_by_odds_of_twenty_to_one_and_not_by_less() -> None:
    assert worse(12.0 * EVEN, 900.0)
    assert not worse(3.0 * EVEN, 900.0)
    assert not worse(-12.0 * EVEN, 900.0)


def test_what_a_rival_loses_must_be_clear_of_its_scatter_from_block_to_block() -> None:
    sides = np.array([1.0, -1.0])
    hardly_known = np.array([20.0, 20.0, *np.tile(20.0 * sides, 4)])
    well_known = 4.0 + 1.6 * np.tile(sides, 5)
    assert hardly_known.sum() == well_known.sum() == pytest.approx(40.0)
    assert not worse(hardly_known, 900.0)
    assert worse(well_known, 900.0)


def test_where_errors_are_independent_odds_alone_decide() -> None:
    assert _margin(np.zeros(0), 900.0, RULES) == RULES.odds


def test_a_fifth_of_a_causes_gain_is_missed_however_few_blocks_it_is_lost_in() -> None:
    assert worse(40.0 * UNEVEN, 150.0)
    assert not worse(40.0 * UNEVEN, 900.0)

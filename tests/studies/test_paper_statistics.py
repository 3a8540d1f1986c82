"""The statistics behind the claims table, on numbers whose answer is known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies.paper.claims import CLAIMS
from studies.paper.persistence import half_life
from studies.paper.statistics import (
    Evidence,
    brown_forsythe,
    holm,
    interval,
    mann_whitney,
    mean,
    outside,
    ratio,
    wilcoxon,
)
from studies.paper.tables import StudyTables
from studies.paper.verdicts import verdict
from studies.paper.weighing import all_more, falls, more, ratio_within, share

RANDOM = np.random.default_rng
LOW, HIGH = np.arange(10.0) + 100.0, np.arange(10.0) + 200.0


def _tables(**columns: np.ndarray) -> StudyTables:
    frame = pd.DataFrame({"food": np.concatenate(list(columns.values()))})
    frame["condition"] = np.repeat(list(columns), [len(v) for v in columns.values()])
    frame["variant"], frame["after"] = "default", frame["food"] / 2.0
    return StudyTables(frame, pd.DataFrame(), 60.0)


def test_there_are_at_least_twelve_claims_and_each_has_its_own_name() -> None:
    keys = [claim.key for claim in CLAIMS]
    assert len(keys) == len(set(keys)) >= 12
    assert {claim.section for claim in CLAIMS} == {"IV-A", "IV-B", "IV-C"}


def test_a_clear_difference_is_unlikely_by_chance_and_only_in_its_direction() -> None:
    assert mann_whitney(HIGH, LOW) < 1e-3
    assert mann_whitney(LOW, HIGH) > 0.99
    assert wilcoxon(HIGH - LOW) < 1e-2
    assert wilcoxon(LOW - HIGH) > 0.99


def test_brown_forsythe_sees_spread_and_not_place() -> None:
    wide, narrow = np.linspace(-50.0, 50.0, 20), np.linspace(999.0, 1001.0, 20)
    assert brown_forsythe(wide, narrow) < 1e-3
    assert brown_forsythe(narrow, wide) > 0.99


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30))
def test_holm_is_between_the_raw_p_and_bonferroni(p: list[float]) -> None:
    adjusted = np.array(holm(p))
    assert (adjusted >= np.array(p) - 1e-12).all()
    assert (adjusted <= np.minimum(1.0, len(p) * np.array(p)) + 1e-12).all() or len(p) > 1
    order = np.argsort(p, kind="stable")
    assert (np.diff(adjusted[order]) >= 0.0).all()
    assert adjusted[order[0]] == pytest.approx(min(1.0, len(p) * min(p)))


def test_holm_leaves_out_what_could_not_be_tested() -> None:
    adjusted = holm([0.01, float("nan"), 0.04])
    assert adjusted[0] == pytest.approx(0.02)
    assert np.isnan(adjusted[1])
    assert adjusted[2] == pytest.approx(0.04)


def test_a_bootstrap_interval_covers_the_truth_about_as_often_as_it_says() -> None:
    random = RANDOM(1)
    covered = 0
    for _ in range(60):
        low, high, _ = interval(mean, [random.normal(5.0, 1.0, 30)], random)
        covered += low <= 5.0 <= high
    assert 50 <= covered <= 60


def test_an_effect_inside_a_region_is_unlikely_outside_it() -> None:
    drawn = np.full(1999, 1.0)
    assert outside(drawn, (0.9, 1.1)) == pytest.approx(1.0 / 2000.0)
    assert outside(drawn, (1.1, 2.0)) == 1.0


def test_verdicts_follow_the_corrected_p_and_the_interval() -> None:
    above_one = (1.0, float("inf"))
    assert verdict(Evidence(2.0, 1.5, 2.5, 1e-4, above_one, 10), 0.01) == "reproduced"
    assert verdict(Evidence(2.0, 1.5, 2.5, 1e-2, above_one, 10), 0.2) == "undecided"
    assert verdict(Evidence(0.8, 0.6, 0.9, 0.99, above_one, 10), 1.0) == "not reproduced"
    assert verdict(Evidence(0.9, 0.6, 1.2, 0.6, above_one, 10), 1.0) == "undecided"
    assert verdict(Evidence(2.0, 1.5, 2.5, 1e-4, above_one, 2), 0.01) == "undecided"
    nan = float("nan")
    assert verdict(Evidence(nan, nan, nan, nan, above_one, 0), nan) == "undecided"


def test_each_kind_of_claim_finds_what_is_there() -> None:
    tables = _tables(poor=LOW, rich=HIGH, alike=LOW + 1.0)
    for weigh in (
        more("rich", "poor", "food"),
        all_more(("rich",), ("poor", "alike"), "food"),
        falls("poor", "food", "after"),
        ratio_within("alike", "poor", "food", (0.9, 1.1)),
        share("rich", ("food",), 150.0),
    ):
        evidence = weigh(tables, RANDOM(0))
        assert evidence.p < 0.01
        assert evidence.low <= evidence.effect <= evidence.high
        assert evidence.region[0] < evidence.effect < evidence.region[1]
    assert more("poor", "rich", "food")(tables, RANDOM(0)).p > 0.99


def test_a_claim_without_data_is_left_open() -> None:
    evidence = more("rich", "nowhere", "food")(_tables(rich=HIGH), RANDOM(0))
    assert np.isnan(evidence.p)
    assert verdict(evidence, float("nan")) == "undecided"


def test_half_life_is_when_the_share_has_fallen_half_way() -> None:
    curve = np.concatenate([np.full(30, 0.8), np.linspace(0.8, 0.2, 15), np.full(15, 0.2)])
    assert half_life(np.tile(curve, (3, 1)), 30) == pytest.approx(7.0, abs=1.0)
    assert np.isnan(half_life(np.full((3, 60), 0.3), 30))


def test_a_ratio_to_nothing_does_not_exist() -> None:
    assert np.isnan(ratio([np.ones(3), np.zeros(3)]))

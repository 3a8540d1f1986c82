"""The statistics behind the claims table, on numbers whose answer is known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy import stats

from realitygap.studies.paper.claims import CLAIMS
from realitygap.studies.paper.persistence import half_life
from realitygap.studies.paper.statistics import (
    ClaimEvidence,
    brown_forsythe,
    interval,
    mann_whitney,
    mean,
    needed,
    outside,
    ratio,
    wilcoxon,
)
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.verdicts import verdict
from realitygap.studies.paper.weighing import (
    all_more,
    at_least,
    falls,
    least_spread,
    less,
    more,
    ratio_within,
    share,
)

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


def test_of_a_table_of_false_claims_one_is_reproduced_in_at_most_a_twentieth_of_studies() -> None:
    claims, studies = 35, 400
    one, other = RANDOM(3).normal(size=(2, studies * claims, 10))
    p = stats.mannwhitneyu(one, other, axis=1, alternative="greater").pvalue
    p = p.reshape(studies, claims)
    wrong = (p < needed(claims)).any(axis=1).mean()
    assert 0.005 < wrong < 0.05 + 3.0 * np.sqrt(0.05 * 0.95 / studies)
    assert (p < needed(1)).any(axis=1).mean() > 0.5  # uncorrected most studies would have one


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


def _evidence(effect: float, p: float, p_against: float, runs: int = 10) -> ClaimEvidence:
    return ClaimEvidence(
        effect, effect - 0.1, effect + 0.1, p, p_against, (1.0, float("inf")), runs
    )


def test_a_verdict_needs_an_estimate_on_its_side_and_a_p_below_the_bar() -> None:
    assert verdict(_evidence(2.0, 1e-3, 1.0), 35) == "reproduced"
    assert verdict(_evidence(2.0, 2e-3, 1.0), 35) == "undecided"
    assert verdict(_evidence(0.5, 1.0, 1e-3), 35) == "not reproduced"
    assert verdict(_evidence(0.5, 1.0, 2e-3), 35) == "undecided"  # whatever its interval
    assert verdict(_evidence(2.0, 1.0, 1e-3), 35) == "undecided"
    assert verdict(_evidence(2.0, 1e-3, 1.0, runs=2), 35) == "undecided"
    nan = float("nan")
    assert verdict(_evidence(nan, nan, nan), 35) == "undecided"


@given(st.floats(0.0, 2.0), st.floats(0.0, 0.01), st.floats(0.0, 0.01), st.integers(1, 50))
def test_one_rule_decides_in_both_directions(
    effect: float, p: float, p_against: float, claims: int
) -> None:
    assume(effect != 1.0)
    turned = {"reproduced": "not reproduced", "not reproduced": "reproduced"}
    found = verdict(_evidence(effect, p, p_against), claims)
    mirrored = verdict(_evidence(2.0 - effect, p_against, p), claims)
    assert mirrored == turned.get(found, found)


def test_the_evidence_against_a_claim_is_the_evidence_for_its_contrary() -> None:
    tables = _tables(poor=LOW, rich=HIGH, alike=LOW + 1.0)
    for claim, contrary in (
        (more("poor", "rich", "food"), more("rich", "poor", "food")),
        (less("rich", "poor", "food"), less("poor", "rich", "food")),
        (falls("poor", "after", "food"), falls("poor", "food", "after")),
        (share("rich", ("food",), 150.0, above=False), share("rich", ("food",), 150.0)),
        (at_least("poor", "rich", "food", 1.0), more("rich", "poor", "food")),
    ):
        assert claim(tables, RANDOM(0)).p_against == contrary(tables, RANDOM(0)).p < 0.01
    spread = _tables(wide=np.linspace(0.0, 100.0, 10), narrow=np.linspace(49.0, 51.0, 10))
    wrong = least_spread("wide", ("narrow",), "food")(spread, RANDOM(0))
    assert wrong.p_against == least_spread("narrow", ("wide",), "food")(spread, RANDOM(0)).p < 0.01


def test_a_claim_of_many_comparisons_needs_all_and_one_contradicts_it_at_the_price_of_all() -> None:
    tables = _tables(poor=LOW, rich=HIGH, alike=LOW + 1.0)
    found = all_more(("rich", "poor"), ("alike",), "food")(tables, RANDOM(0))
    assert found.p_against == pytest.approx(2.0 * mann_whitney(LOW + 1.0, LOW))
    assert found.points == "against"
    assert found.p == mann_whitney(LOW, LOW + 1.0) > 0.5, "the worst of them decides"


def test_a_range_is_left_by_the_resamples_that_do_not_stay_in_it() -> None:
    found = ratio_within("rich", "poor", "food", (0.9, 1.1))(
        _tables(poor=LOW, rich=HIGH), RANDOM(0)
    )
    assert found.p == 1.0
    assert found.p_against == pytest.approx(1.0 / 2001.0)


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
    assert np.isnan([evidence.p, evidence.p_against]).all()
    assert evidence.points == ""
    assert verdict(evidence) == "undecided"


def test_pooled_conditions_are_one_sample() -> None:
    found = share(("poor", "alike"), ("food",), 50.0)(_tables(poor=LOW, alike=LOW + 1.0), RANDOM(0))
    assert found.runs == 20
    assert found.effect == pytest.approx(np.concatenate([LOW, LOW + 1.0]).mean())


def test_half_life_is_when_the_share_has_fallen_half_way() -> None:
    curve = np.concatenate([np.full(30, 0.8), np.linspace(0.8, 0.2, 15), np.full(15, 0.2)])
    assert half_life(np.tile(curve, (3, 1)), 30) == pytest.approx(7.0, abs=1.0)
    assert np.isnan(half_life(np.full((3, 60), 0.3), 30))


def test_a_ratio_to_nothing_does_not_exist() -> None:
    assert np.isnan(ratio([np.ones(3), np.zeros(3)]))

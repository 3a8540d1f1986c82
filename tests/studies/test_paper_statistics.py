"""How claims are decided, on numbers whose answer is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from realitygap.studies.paper.claims import CLAIMS, PAPERS
from realitygap.studies.paper.our_claims import LABOUR
from realitygap.studies.paper.sequential import boundary, looks, shares
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.verdicts import ALIKE, FAILS, HOLDS, OPEN, alone, decide, judge
from realitygap.studies.paper.weighing import (
    Array,
    Claim,
    Comparison,
    half_life,
    mean,
    ratio,
    recovery,
    share,
    spread,
    typical,
    weigh,
)

RANDOM = np.random.default_rng
STUDIES = 200
INFINITE = float("inf")
ABOVE_ONE, TENTH = (1.0, INFINITE), (1 / 1.1, 1.1)


def _tables(**columns: Array) -> StudyTables:
    """Runs of conditions by name; `after` is half of `food`."""
    rows = [
        pd.DataFrame(
            {"condition": name, "run": range(len(food)), "food": food, "after": food / 2.0}
        )
        for name, food in columns.items()
    ]
    runs = pd.concat(rows, ignore_index=True).assign(variant="default")
    return StudyTables(runs, pd.DataFrame({"index": []}), 60.0)


def _claim(
    *comparisons: Comparison, conditions: tuple[str, ...] = ("one",), **changes: object
) -> Claim:
    values = {"claimed": ABOVE_ONE, "alike": TENTH, "because": "", "logarithmic": True, **changes}
    return Claim("claim", "Fig. 6", "", "", conditions, comparisons, **values)  # type: ignore[arg-type]


def _verdict(claim: Claim, tables: StudyTables, batch: int = 10) -> str:
    return str(decide(tables, batch, (claim,))["verdict"][0])


def test_the_paper_has_35_claims_and_each_says_why_its_smallest_effect_matters() -> None:
    keys = [claim.key for claim in CLAIMS]
    assert len(keys) == len(set(keys)) == len(PAPERS) + len(LABOUR)
    assert len(PAPERS) == 35
    assert all(claim.because and claim.conditions for claim in CLAIMS)
    for claim in CLAIMS:  # a claim that has no range of its own has a smallest effect
        assert (claim.alike is None) == (
            np.isfinite(claim.claimed).all() or claim.claimed[0] == 0.85
        ) or (claim.key == "opposite-marginal")


def test_the_boundary_is_the_published_one_of_o_brien_and_fleming_s_spending() -> None:
    def spent(share: float, chance: float) -> float:
        return float(2.0 * stats.norm.sf(stats.norm.isf(chance / 2.0) / np.sqrt(share)))

    found = boundary((0.2, 0.4, 0.6, 0.8, 1.0), 0.025, spent)
    assert found == pytest.approx((4.8769, 3.3569, 2.6803, 2.2898, 2.0310), abs=2e-4)


def test_one_look_at_all_runs_spends_everything() -> None:
    assert boundary((1.0,), 0.025)[0] == pytest.approx(stats.norm.isf(0.025), abs=1e-6)
    assert shares(100) == (1.0,)
    assert looks(10) == (10, 20, 30, 40, 50, 60)


def _wrong(batch_looks: bool, truth: float, seed: int) -> float:
    """Share of studies with a verdict though the truth is where one verdict meets the other."""
    claim = _claim(
        share(("one",), ("food",)), claimed=(truth, INFINITE), alike=None, logarithmic=False
    )
    random, wrong, studies = RANDOM(seed), 0, STUDIES
    for _ in range(studies):
        tables = _tables(one=random.normal(truth, 1.0, 60))
        if batch_looks:
            wrong += _verdict(claim, tables) != OPEN
        else:  # every look as if it were the only one
            firsts = (alone(tables.first(n), (claim,)) for n in looks(10))
            wrong += any(table["verdict"][0] != OPEN for table in firsts)
    return wrong / studies


def test_six_looks_together_are_wrong_in_a_twentieth_of_studies_and_uncorrected_in_many_more() -> (
    None
):
    error = np.sqrt(0.05 * 0.95 / STUDIES)
    assert 0.01 < _wrong(True, 3.0, 1) < 0.05 + 3.0 * error
    assert _wrong(False, 3.0, 1) > 0.05 + 3.0 * error


def test_an_unpaired_interval_is_welch_s() -> None:
    one, other = RANDOM(2).normal(5.0, 1.0, 12), RANDOM(3).normal(3.0, 4.0, 30)
    found = weigh(
        Comparison(lambda t: [one, other], lambda s: mean(s) - mean(s[1:]), False), _tables(one=one)
    )
    welch = stats.ttest_ind(one, other, equal_var=False)
    low, high = welch.confidence_interval(0.95)
    reach = stats.t.isf(0.025, found.freedom) * found.error
    assert (found.value - reach, found.value + reach) == pytest.approx((low, high))
    assert found.runs == 12


def test_a_paired_ratio_of_times_is_student_s_test_on_logarithms() -> None:
    before = np.exp(RANDOM(4).normal(3.0, 1.0, 15))
    tables = _tables(one=before)
    tables.runs["after"] = before * np.exp(RANDOM(5).normal(0.2, 0.1, 15))
    found = weigh(typical("one", ("after", "food")), tables)
    logs = np.log(tables.runs["after"] / tables.runs["food"])
    assert found.value == pytest.approx(logs.mean())
    assert found.error == pytest.approx(logs.std(ddof=1) / np.sqrt(15))


def test_the_interval_of_a_ratio_of_spreads_covers_the_truth_about_as_often_as_it_says() -> None:
    random, covered, studies = RANDOM(6), 0, 120
    for _ in range(studies):
        one, other = (np.exp(random.normal(0.0, s, 40)) for s in (0.3, 0.1))
        found = weigh(spread("one", "other", ("food", "food")), _tables(one=one, other=other))
        reach = stats.t.isf(0.025, found.freedom) * found.error
        covered += abs(found.value - np.log(3.0)) < reach
    assert 0.95 - 3.0 * np.sqrt(0.05 * 0.95 / studies) <= covered / studies < 1.0


def test_the_rule_has_three_answers_and_no_fourth() -> None:
    for interval, expected in (
        ((0.95, 1.05), ALIKE),
        ((1.01, 1.09), ALIKE),  # a difference, but none that matters
        ((1.01, 1.2), HOLDS),
        ((0.8, 0.99), FAILS),
        ((0.8, 1.05), OPEN),
        ((0.95, 1.3), OPEN),
        ((float("nan"), 2.0), OPEN),
    ):
        assert judge(*interval, ABOVE_ONE, TENTH) == expected
    assert judge(0.95, 1.05, (0.9, 1.1), None) == HOLDS
    assert judge(1.2, 1.3, (0.9, 1.1), None) == judge(0.1, 0.8, (0.9, 1.1), None) == FAILS


@given(st.floats(-3.0, 3.0), st.floats(0.0, 3.0), st.floats(0.01, 1.0))
def test_the_rule_is_the_same_to_both_sides(low: float, width: float, matters: float) -> None:
    high, alike = low + width, (-matters, matters)
    turned = {HOLDS: FAILS, FAILS: HOLDS}
    found = judge(low, high, (0.0, INFINITE), alike)
    assert judge(-high, -low, (0.0, INFINITE), alike) == turned.get(found, found)
    if width < matters:  # so many runs decide whatever is true
        assert found != OPEN


@pytest.mark.parametrize(("truth", "expected"), [(1.5, HOLDS), (0.6, FAILS), (1.0, ALIKE)])
def test_what_is_clear_is_decided_and_rightly(truth: float, expected: str) -> None:
    random = RANDOM(7)
    tables = _tables(one=random.normal(100.0 * truth, 8.0, 60), other=random.normal(100.0, 8.0, 60))
    claim = _claim(ratio(("one",), ("other",), "food"), conditions=("one", "other"))
    assert _verdict(claim, tables) == expected


def test_the_first_look_that_decides_is_final() -> None:
    food = np.concatenate([RANDOM(8).normal(200.0, 5.0, 10), RANDOM(9).normal(60.0, 5.0, 50)])
    claim = _claim(
        share(("one",), ("food",)), claimed=(100.0, INFINITE), alike=None, logarithmic=False
    )
    found = decide(_tables(one=food), 10, (claim,))
    assert (found["verdict"][0], found["runs"][0]) == (HOLDS, 10)


def test_a_look_needs_all_runs_of_all_conditions() -> None:
    claim = _claim(ratio(("one",), ("other",), "food"), conditions=("one", "other"))
    tables = _tables(one=np.arange(20.0) + 200.0, other=np.arange(10.0) + 100.0)
    assert decide(tables, 10, (claim,))["runs"][0] == 10
    gap = replace(tables, runs=tables.runs[tables.runs["run"] != 3])
    assert decide(gap, 10, (claim,))["runs"][0] == 0
    assert _verdict(claim, gap) == OPEN


def test_a_claim_of_many_comparisons_needs_all_and_one_is_enough_against_it() -> None:
    random = RANDOM(10)
    levels = {"top": 300.0, "good": 200.0, "poor": 100.0}
    tables = _tables(**{name: random.normal(level, 5.0, 10) for name, level in levels.items()})

    def least(*pairs: tuple[str, str]) -> str:
        needed = [ratio((a,), (b,), "food") for a, b in pairs]
        return _verdict(_claim(*needed, conditions=tuple(levels)), tables)

    assert least(("top", "poor"), ("good", "poor")) == HOLDS
    assert least(("top", "poor"), ("poor", "good")) == FAILS
    assert least(("top", "poor"), ("good", "good")) == ALIKE


def test_the_price_of_choosing_the_least_comparison_is_their_number() -> None:
    tables = _tables(one=RANDOM(14).normal(100.0, 9.0, 10), other=RANDOM(15).normal(90.0, 9.0, 10))
    versus = ratio(("one",), ("other",), "food")
    single, many = (
        alone(tables, (_claim(*[versus] * number, conditions=("one", "other")),)).iloc[0]
        for number in (1, 5)
    )
    assert many["low"] == pytest.approx(single["low"])
    freedom = weigh(versus, tables).freedom
    reach, longer = (np.log(one["high"] / one["effect"]) for one in (single, many))
    assert longer / reach == pytest.approx(
        stats.t.isf(0.025 / 5, freedom) / stats.t.isf(0.025, freedom)
    )


def test_a_larger_family_asks_for_more() -> None:
    tables = _tables(one=RANDOM(11).normal(1.0, 1.0, 60))
    claim = _claim(
        share(("one",), ("food",)), claimed=(0.0, INFINITE), alike=None, logarithmic=False
    )
    widths = []
    for size in (1, 20):
        claims = tuple(replace(claim, key=str(i)) for i in range(size))
        found = decide(tables.first(10), 10, claims)
        widths.append(found["high"][0] - found["low"][0])
    assert widths[1] > 1.2 * widths[0]


def test_families_in_which_nothing_is_decided_cost_the_others() -> None:
    tables = _tables(one=RANDOM(12).normal(9.0, 1.0, 10), dull=RANDOM(13).normal(0.0, 1.0, 10))
    clear = _claim(
        share(("one",), ("food",)), claimed=(0.0, INFINITE), alike=None, logarithmic=False
    )
    dull = replace(clear, key="dull", family="Fig. 7", comparisons=(share(("dull",), ("food",)),))
    apart, beside = decide(tables, 10, (clear,)), decide(tables, 10, (clear, dull))
    assert beside["verdict"].tolist() == [HOLDS, OPEN]
    assert beside["bound"][0] > apart["bound"][0]


def test_a_claim_without_data_is_left_open() -> None:
    claim = _claim(ratio(("one",), ("nowhere",), "food"), conditions=("one", "nowhere"))
    tables = _tables(one=np.arange(10.0))
    assert _verdict(claim, tables) == alone(tables, (claim,))["verdict"][0] == OPEN
    assert np.isnan(weigh(ratio(("one",), ("one",), "food"), _tables(one=np.zeros(5))).value)


def test_pooled_conditions_are_one_sample_and_what_does_not_occur_is_left_out() -> None:
    low = np.arange(10.0)
    tables = _tables(one=low, other=np.append(low[:-1] + 1.0, np.nan))
    found = weigh(share(("one", "other"), ("food",)), tables)
    assert found.runs == 19
    assert found.value == pytest.approx(np.concatenate([low, low[:-1] + 1.0]).mean())


def test_a_swarm_has_recovered_when_it_is_back_at_four_fifths_after_its_lowest() -> None:
    curve = np.array([[5.0] * 30 + [1.0] * 10 + [5.0] * 20])
    assert recovery(curve, 30) == pytest.approx(10.0, abs=1.0)
    assert recovery(np.full((2, 60), 3.0), 30) == 0.0
    assert recovery(np.array([[5.0] * 30 + [1.0] * 30]), 30) == 30.0
    assert np.isnan(recovery(np.zeros((2, 60)), 30))


def test_half_life_is_when_the_share_has_fallen_half_way() -> None:
    curve = np.concatenate([np.full(30, 0.8), np.linspace(0.8, 0.2, 15), np.full(15, 0.2)])
    assert half_life(np.tile(curve, (3, 1)), 30) == pytest.approx(7.0, abs=1e-6)
    assert np.isnan(half_life(np.full((3, 60), 0.3), 30))
    assert half_life(np.array([[0.9] * 30 + [0.1] * 30]), 30) < 1.0

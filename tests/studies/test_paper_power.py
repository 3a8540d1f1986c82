"""What so many runs can decide is said as it is."""

from __future__ import annotations

import pytest
from scipy import stats

from realitygap.studies.paper.power import TESTS, detectable, may_disagree, power_table, power_text

WILCOXON, MANN_WHITNEY, BROWN_FORSYTHE = TESTS


def test_wilcoxon_over_ten_runs_decides_only_what_is_unanimous() -> None:
    assert may_disagree(10, 35) == 0
    assert "decides only what all 10 agree on" in power_text(10, 35)
    # then its power is the chance that ten runs of ten lie on one side
    unanimous = stats.norm.ppf(0.8**0.1)
    assert detectable(WILCOXON, 10, 35) == pytest.approx(unanimous, abs=0.1)


def test_few_runs_decide_nothing_and_more_runs_decide_smaller_differences() -> None:
    assert may_disagree(9, 35) == -1
    assert "never decides" in power_text(2, 35)
    assert set(power_table(2, 35).iloc[:, -1]) == {"none"}
    assert may_disagree(20, 35) > 0
    assert detectable(MANN_WHITNEY, 30, 35) < detectable(MANN_WHITNEY, 10, 35)
    assert detectable(BROWN_FORSYTHE, 30, 35) < 3.0


def test_a_claim_alone_is_decided_more_easily_than_one_of_many() -> None:
    assert detectable(MANN_WHITNEY, 10, 1) < detectable(MANN_WHITNEY, 10, 35)

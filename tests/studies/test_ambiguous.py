"""What a log left open is settled by the manoeuvre that the diagnosis proposes."""

from __future__ import annotations

import pytest

from realitygap.studies.measure.ambiguous import PAIRS, trial


def test_readings_of_robots_settle_whether_the_wall_or_the_sensors_are_at_fault() -> None:
    found = trial("wall or sensors", "ir_gain", 404)
    assert found["first"].startswith("ambiguous: ")
    assert found["proposed"] == "face-to-face"
    assert found["right"], found["both"]


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
def test_ambiguous_pairs_are_settled(name: str) -> None:
    truths = list(PAIRS[name].hide)
    found = [trial(name, truths[k % 2], 900 + k) for k in range(10)]
    left_open = [one for one in found if one["ambiguous"]]
    assert len(left_open) >= 4
    wrong = [one for one in left_open if not one["right"]]
    assert len(wrong) <= 0.1 * len(left_open), wrong

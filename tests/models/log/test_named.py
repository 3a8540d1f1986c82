"""Robots that a log calls by name."""

from __future__ import annotations

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.log.measured import make_log
from realitygap.models.log.named import numbered
from tests.models.small import driven_log

NAMES = {0: "robot10", 1: "robot2"}


def named_log():
    frame = driven_log(2, rows=300)
    return frame.assign(robot=frame["robot"].map(NAMES))


def test_robots_by_name_get_numbers_in_natural_order():
    robots, names = numbered(pd.Series(["robot10", "robot2", "robot10"]))
    assert list(robots) == [1, 0, 1]
    assert names == {0: "robot2", 1: "robot10"}
    assert names[0] == "robot2"
    assert names[7] == "7"


def test_numbers_that_are_known_stay_and_new_names_get_free_ones():
    robots, names = numbered(pd.Series(["carol", "alice"]), {"alice": 0, "bob": 1})
    assert list(robots) == [2, 0]
    assert names == {0: "alice", 2: "carol"}


@given(st.lists(st.integers(0, 99), min_size=1))
def test_numbers_stay_numbers_also_as_text(ids):
    for column in (pd.Series(ids), pd.Series([str(one) for one in ids])):
        robots, names = numbered(column)
        assert robots.equals(column)
        assert names == {}


def test_a_column_of_long_texts_names_no_robots():
    with pytest.raises(InputError, match="at most 60 letters"):
        numbered(pd.Series(["x" * 61]))


def test_a_log_keeps_the_names_beside_its_numbers():
    log = make_log(named_log(), drive=Drive())
    assert log.names == {0: "robot2", 1: "robot10"}
    assert list(log.segments["robot"]) == [0, 1]
    assert set(log.robots) == {"robot2", "robot10"}


def test_a_refusal_calls_a_robot_by_its_name():
    frame = named_log()
    frame.loc[frame["robot"] == "robot2", "t"] = 0.0
    with pytest.raises(InputError, match="t of robot robot2 in run a"):
        make_log(frame, drive=Drive())


def test_empty_names_are_refused():
    frame = named_log()
    frame.loc[3, "robot"] = None
    with pytest.raises(InputError, match="robot: got 1 empty"):
        make_log(frame, drive=Drive())

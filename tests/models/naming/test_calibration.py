"""What has no name is predicted all the same, by values that are no diagnosis."""

from __future__ import annotations

from functools import cache

import pytest

from realitygap.embedded_sim import Drive
from realitygap.models.belief.extended import as_written, extended_text, read_back
from realitygap.models.belief.extension import Extension
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.gap.conditions import conditions
from realitygap.models.log.measured import make_log
from realitygap.models.naming.claims.ahead import Ahead
from realitygap.models.naming.claims.calibration import _calibrated
from realitygap.models.naming.diagnosis import Calibrated, Diagnosis, as_json, extension
from realitygap.models.naming.rules import Rules
from tests.models.small import driven_log

MODEL = read_model_file("epuck").model_copy(update={"arena": None})


@cache
def calibrated(drive: Drive, *, rows: int = 3000) -> Calibrated | None:
    """What is fitted to a minute or two of a robot of some drive."""
    frame = driven_log(4, robots=1, rows=rows, drive=drive, position_noise=5e-4, heading_noise=5e-3)
    log = make_log(frame, drive=Drive())
    return _calibrated(Ahead(log, conditions(log, MODEL)), MODEL, 0, Rules())


def values(found: Calibrated) -> dict[str, float]:
    return {one.name: next(iter(one.parameters.values())).value for one in found.terms}


def test_a_slow_and_small_robot_is_predicted_by_its_own_numbers() -> None:
    found = calibrated(Drive(time_constant=0.4, wheel_radius=(0.0185, 0.0185)))
    assert found is not None
    assert values(found)["motor_lag"] == pytest.approx(0.4, rel=0.1)
    assert values(found)["wheel_radius_scale"] == pytest.approx(0.0185 / 0.0205, rel=0.01)
    assert all(after < 0.5 * before for before, after in found.errors.values())


def test_a_robot_that_moves_as_simulated_is_left_alone() -> None:
    assert calibrated(Drive()) is None


def test_too_little_to_check_on_gives_nothing() -> None:
    assert calibrated(Drive(time_constant=0.4), rows=20) is None


def test_the_extended_model_holds_it_and_says_that_it_is_no_cause() -> None:
    found = calibrated(Drive(time_constant=0.4, wheel_radius=(0.0185, 0.0185)))
    assert found is not None
    diagnosis = Diagnosis(named=(), calibration=(found,), robots=(0, 1))
    told = as_json(diagnosis)["calibration"]
    assert [one["robot"] for one in told] == [0]
    assert set(told[0]["errors"]) == set(found.errors)
    added = extension(diagnosis, log_hash="", command="")
    assert added.causes == ()
    read = read_back(extended_text(MODEL, added))
    assert read.extension is not None
    assert read.extension.causes == ()
    assert read.motion(0).drive.time_constant == pytest.approx(0.4, rel=0.1)
    assert read.motion(1) == MODEL.motion(1)


def test_a_second_extension_keeps_the_first_ones_values() -> None:
    found = calibrated(Drive(time_constant=0.4, wheel_radius=(0.0185, 0.0185)))
    assert found is not None
    first = read_back(extended_text(MODEL, Extension(calibration=found.terms)))
    again = as_written(first, ())
    assert again.motion(0) == first.motion(0) != MODEL.motion(0)


def test_robots_are_calibrated_where_something_is_open_and_nowhere_else() -> None:
    from realitygap.models.naming.claims.calibration import _open
    from realitygap.models.naming.diagnosis import Unexplained

    left = Unexplained(channel="speed", share=0.5, where="", robots=(2,))
    known = Diagnosis(named=(), robots=(0, 1, 2), reference="epuck")
    assert _open(known) == []
    assert _open(Diagnosis(**{**vars(known), "unexplained": (left,)})) == [2]
    assert _open(Diagnosis(**{**vars(known), "reference": ""})) == [0, 1, 2]

from __future__ import annotations

from dataclasses import replace

import pytest

from realitygap.models.naming.diagnosis import Detectable, Diagnosis, Unexplained
from realitygap.studies.diagnosis.words import detectable_sentence, verdict_sentence
from tests.models.naming.test_diagnosis import LAG, named

LEFT = Unexplained(channel="motion", share=0.2, where="it drifts", robots=(1,), quantity="error")
REFUSED = replace(named(), exported=False, why="seen, but worse: not exported")


@pytest.mark.parametrize(
    ("found", "begins"),
    [
        (Diagnosis(named=(), robots=(0, 1)), "Nothing wrong: no robot differs"),
        (
            Diagnosis(named=(), robots=(0, 1), untold={1: ("wheel_separation",)}),
            "The log cannot tell whether anything is wrong: in robot 1 wheel_separation of 5 %",
        ),
        (Diagnosis(named=(named(),)), "Named: robot 3: motor_saturation (left) limit 4.5"),
        (Diagnosis(named=(named(rivals=(LAG,)),)), "The log cannot decide: robot 3"),
        (Diagnosis(named=(), unexplained=(LEFT,)), "Something is wrong that no known cause"),
        (Diagnosis(named=(REFUSED,)), "Something is wrong that no known cause accounts for"),
    ],
)
def test_the_headline_says_which_of_five_verdicts_it_is(found: Diagnosis, begins: str) -> None:
    known = replace(found, reference="e-puck")
    assert verdict_sentence(known).startswith(begins)
    assert "reference" not in verdict_sentence(known)


@pytest.mark.parametrize("left", [(), (LEFT,)])
def test_without_a_reference_the_headline_says_so(left: tuple[Unexplained, ...]) -> None:
    said = verdict_sentence(Diagnosis(named=(), unexplained=left))
    assert "healthy" in said
    assert said != verdict_sentence(Diagnosis(named=(), unexplained=left, reference="e-puck"))


def test_what_is_named_is_not_said_to_be_unexplained() -> None:
    said = verdict_sentence(Diagnosis(named=(named(),), unexplained=(LEFT,), reference="e-puck"))
    unknown, beside = said.split("Beside it is named: ")
    assert "motor_saturation" in beside
    assert "motor_saturation" not in unknown
    both = verdict_sentence(Diagnosis(named=(named(), REFUSED), reference="e-puck"))
    assert both.split("Beside it is named: ")[0].count("motor_saturation") == 1


def test_what_is_decided_is_not_said_to_be_undecided() -> None:
    found = Diagnosis(named=(named(rivals=(LAG,)), named()), reference="e-puck")
    undecided, beside = verdict_sentence(found).split("Beside it is named: ")
    assert undecided.count("motor_saturation") == beside.count("motor_saturation") == 1
    assert "or motor_lag" in undecided
    assert "motor_lag" not in beside


def test_why_a_cause_is_not_exported_stands_in_the_headline() -> None:
    assert "seen, but worse: not exported" in verdict_sentence(Diagnosis(named=(REFUSED,)))


def test_what_would_have_shown_is_said_in_units_and_in_its_direction() -> None:
    said = detectable_sentence(
        [
            Detectable(cause="wheel_radius_mismatch", parameter="ratio", unit="right/left",
                       null=1.0, size=0.006, robot=0),
            Detectable(cause="motor_saturation", parameter="limit", unit="rad/s", null=None,
                       size=5.3, robot=0),
            Detectable(cause="low_friction", parameter="friction", unit="1", null=1.2,
                       size=0.75, robot=0),
            Detectable(cause="motor_dead_zone", parameter="threshold", unit="rad/s", null=0.0,
                       size=None, robot=0),
        ]
    )  # fmt: skip
    assert "wheel_radius_mismatch above 0.6 %" in said
    assert "motor_saturation limit below 5.3 rad/s" in said
    assert "low_friction friction below 0.45" in said
    assert said.endswith("would not have shown in every robot: motor_dead_zone.")

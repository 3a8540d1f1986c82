"""What no healthy reference has measured is neither named nor called unexplained, and said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np
import pytest

from realitygap.embedded_sim import Drive
from realitygap.embedded_sim.senses import Senses
from realitygap.models.belief.catalogue import every_cause, sense_causes
from realitygap.models.belief.cause import Parameter
from realitygap.models.belief.senses import Belief, SenseCause
from realitygap.models.log.measured import make_log
from realitygap.models.log.schema import PS
from realitygap.models.naming.channels.motion.diagnose import diagnose
from realitygap.models.naming.channels.senses.diagnose import SenseExamination, diagnose_senses
from realitygap.models.naming.health.reference import Reference, shipped_file
from realitygap.models.naming.health.senses import SenseReference, beside, read_sense_reference
from tests.models.naming.test_identify import HEALTHY, diagnosed, names, reference, table
from tests.models.naming.test_identify import MODEL as PLAIN
from tests.models.naming.test_senses import MODEL
from tests.models.naming.test_senses import table as sensed


def _dusty(belief: Belief, values: np.ndarray, variant: str) -> Belief:
    gain = tuple(float(values[0]) * one for one in belief.senses.ps_gain)
    return replace(belief, senses=replace(belief.senses, ps_gain=gain))


DUSTY = SenseCause(
    name="ir_dusty",
    meaning="dust lies on the infrared sensors",
    parameters=(
        Parameter(name="scale", unit="1", null=1.0, low=0.1, high=2.0, step=0.01, link="factor"),
    ),
    sense=_dusty,
    kind="ps",
    columns=PS,
    experiment="tour",
)
AS_SEEN_IN_HEALTH = Belief(senses=Senses(ps_gain=(1.011,) * 8))
"""Captured tables are a per cent short, in every healthy robot: no cause's null."""


def examined(known: SenseReference) -> SenseExamination:
    log = make_log(sensed({}, everybody=AS_SEEN_IN_HEALTH), drive=MODEL.drive)
    return diagnose_senses(log, MODEL, known)


def shipped() -> SenseReference:
    motion = shipped_file("e-puck")
    assert motion is not None
    return read_sense_reference(beside(motion))


def test_a_cause_in_the_senses_that_is_new_to_the_reference_accuses_nobody(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sense_causes(), DUSTY.name, DUSTY)
    monkeypatch.setitem(every_cause(), DUSTY.name, DUSTY)
    found = examined(shipped())
    assert found.named == ()
    said = [text for text in found.not_checked if text.startswith(DUSTY.name)]
    assert len(said) == 1
    assert "realitygap reference" in said[0]


def test_without_the_healthy_noise_no_robot_is_called_noisy_and_it_is_said() -> None:
    found = examined(without_columns(shipped(), "ir_noise.", "infrared/noise"))
    assert found.named == ()
    assert any(text.startswith("ir_noise: not named") for text in found.not_checked)


def test_without_what_robots_reflect_the_wall_is_not_told_from_the_sensors() -> None:
    found = examined(without_columns(shipped(), "targets."))
    assert any("ir_gain and wall_albedo of all robots" in text for text in found.not_checked)


Kept = TypeVar("Kept", Reference, SenseReference)


def without_columns(whole: Kept, *begin: str) -> Kept:
    """A reference without the coefficients of such names."""
    return only(whole, lambda name: not name.startswith(begin))


def only(whole: Kept, chosen: Callable[[str], bool]) -> Kept:
    """A reference with some coefficients alone."""
    kept = [chosen(name) for name in whole.causes]
    related = np.array(whole.correlation)[np.ix_(kept, kept)]
    return whole.model_copy(
        update={
            "columns": {k: v for k, v in whole.columns.items() if chosen(k)},
            "causes": tuple(name for name in whole.causes if chosen(name)),
            "correlation": tuple(map(tuple, related.tolist())),
        }
    )


def knowing(chosen: Callable[[str], bool]) -> Reference:
    """The healthy reference with some coefficients alone."""
    return only(reference(), chosen)


def test_a_cause_in_motion_that_the_reference_does_not_know_is_not_named() -> None:
    wide = table(13, {1: replace(HEALTHY, axle=0.056)})
    assert names(diagnosed(wide)) == [("wheel_separation", (1,))]
    found = diagnosed(wide, knowing(lambda name: not name.startswith("wheel_separation.")))
    assert not [one for one in found.named if one.term.cause.name == "wheel_separation"]
    said = [text for text in found.not_checked if text.startswith("wheel_separation")]
    assert len(said) == 1
    assert "realitygap reference" in said[0]


def test_what_a_motion_may_follow_is_judged_only_where_health_is_known() -> None:
    frame = table(12, {})
    frame.loc[frame["robot"] == 1, "x"] *= 1.06
    assert diagnosed(frame).unexplained[0].quantity == "heading_twice"
    found = diagnosed(frame, knowing(lambda name: "heading_twice" not in name))
    assert "heading_twice" not in {one.quantity for one in found.unexplained}
    assert any("which axis it faces along" in text for text in found.not_checked)
    nothing = diagnosed(frame, knowing(lambda name: "/" not in name))
    assert not [one for one in nothing.unexplained if one.channel == "bend"]
    assert any("anything follows a measured quantity" in text for text in nothing.not_checked)


def test_without_health_torque_and_friction_are_shares_of_nothing() -> None:
    log = make_log(table(13, {1: replace(HEALTHY, acceleration=(40.0, 40.0))}), drive=Drive())
    found = diagnose(log, PLAIN, None).diagnosis
    assert not {one.term.cause.name for one in found.named} & {"weak_motor", "low_friction"}
    assert any(text.startswith("low_friction, weak_motor: not told") for text in found.not_checked)


def test_a_log_says_nothing_of_a_reference_that_knows_all() -> None:
    found = diagnosed(table(13, {}))
    assert not [text for text in found.not_checked if "healthy reference" in text]

"""Late poses are told from late commands by what the sensors read."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.models.belief.catalogue import causes, without
from realitygap.models.belief.cause import ALL
from realitygap.models.belief.senses import Belief
from realitygap.models.log.held_out import parts
from realitygap.models.log.measured import make_log
from realitygap.models.naming.channels.senses.clock import Shift, shifts, told_apart
from realitygap.models.naming.channels.senses.robot import SenseLog
from realitygap.models.naming.channels.senses.sight import look
from realitygap.models.naming.diagnosis import Unexplained
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Evidence, Named
from realitygap.models.naming.health.reference import Column
from realitygap.models.naming.health.senses import no_sense_reference
from tests.models.naming.test_senses import MODEL, STEP, table

HEALTHY = Column(mean=0.0, sd=0.001, swarm_sd=0.0)


def late(seconds: float, name: str, *others: str) -> Named:
    """A delay of robot 5 as motion names it."""
    term = Term(causes()[name], ALL)
    evidence = Evidence(
        term=term,
        coordinates=np.array([seconds]),
        covariance=np.zeros((1, 1)),
        gain=100.0,
        share=0.1,
        distance=20.0,
    )
    return Named(
        term=term,
        robots=(5,),
        whole_swarm=False,
        values=(Value("seconds", seconds, seconds - 2e-3, seconds + 2e-3, "s"),),
        evidence=evidence,
        twins=tuple(Term(causes()[other], ALL) for other in others),
    )


def seen(seconds: float) -> Shift:
    return Shift(np.array([0.0, seconds]), np.array([0.001, 0.001]))


def said(one: Named, shift: Shift) -> tuple[str, list[str]]:
    found = told_apart(one, (4, 5), shift, HEALTHY)
    assert isinstance(found, Named)
    return found.term.cause.name, [t.cause.name for t in found.twins]


def test_poses_stamped_late_shift_against_the_readings_of_their_robot_alone() -> None:
    frame = table({}, swing=2.0)
    mine = frame["robot"] == 1
    for name in ("x", "y", "yaw"):
        values = frame.loc[mine, name].to_numpy()
        at = np.arange(len(values)) - 0.016 / STEP
        frame.loc[mine, name] = np.interp(at, np.arange(len(values)), np.unwrap(values))
    log = make_log(frame, drive=MODEL.drive)
    robots = SenseLog(log, MODEL, look(log, MODEL), of_log=parts(log))
    found = shifts(robots.at(range(4), [Belief()] * 4), no_sense_reference("toy").learned)
    assert found.seconds[1] == pytest.approx(0.016, abs=4.0 * found.error[1])
    assert found.seconds[1] > 8.0 * found.error[1]
    others = [0, 2, 3]
    assert np.all(np.abs(found.seconds[others]) < 5.0 * found.error[others])


def test_sensors_decide_where_motion_leaves_both_open() -> None:
    either = late(0.016, "command_latency", "clock_offset")
    assert said(either, seen(0.015)) == ("clock_offset", [])
    assert said(either, seen(0.001)) == ("command_latency", [])
    assert said(late(0.016, "clock_offset", "command_latency"), seen(0.0)) == (
        "command_latency",
        [],
    )


def test_sensors_that_do_not_tell_leave_both_open() -> None:
    either = late(0.002, "command_latency", "clock_offset")
    assert said(either, seen(0.001)) == ("command_latency", ["clock_offset"])
    blind = Shift(np.array([0.0, np.nan]), np.array([0.001, np.inf]))
    assert said(late(0.016, "command_latency", "clock_offset"), blind)[1] == ["clock_offset"]


def test_sensors_against_encoders_make_a_sure_name_ambiguous() -> None:
    assert said(late(0.016, "clock_offset"), seen(0.0)) == ("clock_offset", ["command_latency"])


def test_a_delay_that_the_sensors_exclude_is_unexplained_without_its_twin() -> None:
    with without(("command_latency",)):
        found = told_apart(late(0.016, "clock_offset"), (4, 5), seen(0.0), HEALTHY)
    assert isinstance(found, Unexplained)
    assert found.robots == (5,)
    assert found.quantity == "change"


def test_other_causes_are_none_of_the_clocks_business() -> None:
    lag = late(0.016, "motor_lag")
    assert told_apart(lag, (4, 5), seen(0.016), HEALTHY) is lag

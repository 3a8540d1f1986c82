"""Sealed laws are physical, and what is said of them is counted as it was meant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from realitygap.models.belief.catalogue import every_cause
from realitygap.reality import constants as k
from realitygap.reality.effects import parse_effects
from realitygap.reality.world import World
from tests.laws.battery import answered, plan, rates, scored
from tests.laws.sealed import EFFECTS, LAWS, LISTED, SHARE


def driven(spec: str, pose: list[float], seconds: float = 1.0) -> np.ndarray:
    """(3,) change of the pose of a robot that is told to go straight."""
    poses = np.array([pose, [0.5, -0.2, 0.0]])
    effects = parse_effects((spec,), 2, EFFECTS) if spec else ()
    here = World(2, np.random.SeedSequence(1), effects=effects, poses=poses)
    for _ in range(round(seconds / k.CONTROL_STEP)):
        here.sense()
        here.act(np.full((2, 2), 6.0))
    here.sense()
    here.close()
    return np.asarray(here.poses[0] - poses[0])


def test_half_of_the_laws_are_in_the_grammar() -> None:
    assert sum(law.inside for law in LAWS) == len(LAWS) // 2
    assert len({law.name for law in LAWS}) == len(LAWS)


def test_a_law_changes_a_share_of_what_wheels_do_where_it_holds() -> None:
    on = driven("pond:bars=4,robot=0", [0.14, 0.1, 0.0])
    off = driven("pond:bars=4,robot=0", [-0.4, 0.1, 0.0])
    free = driven("", [0.14, 0.1, 0.0])
    assert on[0] / free[0] == pytest.approx(1.0 - 4 * SHARE, abs=0.01)
    assert off[0] / free[0] == pytest.approx(1.0, abs=0.005)


def test_a_compass_turns_the_robot_by_its_rate() -> None:
    turned = driven("compass:bars=4,robot=0", [-0.4, 0.0, 0.9 + np.pi / 2])
    assert turned[2] == pytest.approx(0.12, abs=0.015)


def said(**changes: Any) -> dict[str, Any]:
    law = {
        "equation": "e",
        "shape": True,
        "channel": "turn",
        "of": "heading",
        "atoms": [{"form": "cosine"}],
        "coefficients": [{"low": 0.02, "high": 0.2}],
        "errors": {},
        "exported": True,
        **changes,
    }
    return {"verdict": "unexplained", "laws": [law]}


def judged(answer: dict[str, Any]) -> tuple[bool, bool, bool]:
    """Channel and quantity right, form right, wrong."""
    return answer["quantity"], answer["form"], answer["wrong"]


def test_what_is_right_and_what_is_wrong() -> None:
    trials = plan(3, healthy=0, robots=5, seconds=60.0)
    compass = next(one for one in trials if one.law is not None and one.law.name == "compass")
    right = scored(compass, said())
    assert judged(right) == (True, True, False)
    assert right["holds"] == [True]
    other = scored(compass, said(of="time"))
    assert judged(other) == (False, False, True)
    curve = scored(compass, said(shape=False, of="time"))
    assert judged(curve) == (False, False, False)
    assert scored(compass, said(coefficients=[{"low": 0.3, "high": 0.4}]))["holds"] == [False]
    silent = scored(compass, {"verdict": "nothing_wrong"})
    lines = list(rates([right, other, silent]))
    assert lines[0] == "channel and quantity right: 1 of 3"
    assert lines[7] == "nothing said: 1 of 3"


def test_a_listed_cause_is_hidden_as_the_blind_battery_does_and_withheld() -> None:
    trials = plan(3, healthy=1, robots=5, seconds=60.0)
    mine = [one for one in trials if one.withheld]
    assert {one.withheld for one in mine} == {(law.name,) for law in LISTED}
    assert all(name in every_cause() for one in mine for name in one.withheld)
    for one in mine:
        parse_effects(one.specs, 5)
    slow = next(one for one in mine if one.withheld == ("speed_droop",))
    both = scored(slow, said(channel="both", of="time", atoms=[{"form": "power"}]))
    assert judged(both) == (True, True, False)
    assert "holds" not in both  # an amplitude of another unit


@pytest.mark.slow
def test_a_battery_of_fresh_logs() -> None:
    """Four of the laws inside the grammar and one healthy run; the whole battery is run by hand."""
    every = plan(7, healthy=1, robots=4, seconds=90.0)
    names = ("compass", "carpet", "eccentric", "shy")
    some = [one for one in every if one.law is None or one.law.name in names]
    answers = [scored(one, answered(one)) for one in some]
    assert sum(bool(one.get("quantity")) for one in answers) >= 3
    assert not any(one.get("wrong") for one in answers)
    assert not any(one["laws"] for one in answers if one["law"] is None)

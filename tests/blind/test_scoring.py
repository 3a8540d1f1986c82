"""Every kind of answer has one score, and no answer is scored better than it is."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from realitygap.studies.blind.scoring import Score, of_robots, outcome, score
from realitygap.studies.blind.summary import ABSTAINED, unknowns
from realitygap.studies.blind.trials import Hidden, Kind, Trial
from realitygap.studies.run.experiment import RunConfig

RADIUS = Hidden("wheel_radius_scale", {"scale": 1.02}, (3,), 0.02, 2.0)
LAG = Hidden("motor_lag", {"time_constant": 0.1}, (4,), 0.1, 4.0)
LEFT = Hidden("motor_saturation", {"limit": 4.0, "wheel": "left"}, (3,), 0.36, 3.6)
DEAD = Hidden("ls_dead_sensor", {"sensor": "5"}, (3,), 0.0, 1.0)
SWARM = replace(RADIUS, robots=())
PLACE = Hidden("lamp_moved", {"x": 0.03, "y": 0.0}, (), 0.03, 3.0)
TWO = replace(RADIUS, robots=(3, 4))
STRANGE = Hidden("speed_loss", {"share": 0.05}, (3,), 0.05, 2.5)
ALL = "all"


def trial(*hidden: Hidden, kind: Kind | None = None) -> Trial:
    usual: Kind = "healthy" if not hidden else "single" if len(hidden) == 1 else "pair"
    return Trial(0, kind or usual, 120.0, RunConfig(robots=10), hidden)


def cause(name: str, robots: Any, *rivals: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "robots": robots, "parameters": {}, "alternatives": [*rivals], **more}


def says(verdict: str, *causes: dict[str, Any]) -> dict[str, Any]:
    return {"verdict": verdict, "causes": [*causes], "unexplained": []}


def values(**found: Any) -> dict[str, Any]:
    return {"parameters": {k: v if isinstance(v, dict) else {"value": v} for k, v in found.items()}}


R, L = "wheel_radius_scale", "motor_lag"
RIGHT = cause(R, [3])
WIDE, NARROW = ({"value": 1.02, "low": low, "high": 1.03} for low in (1.01, 1.025))
NO = (False,)
YES = (True,)

TABLE = {
    # hidden, answer, right, among, wrong, healthy, accused, inside, outcome
    "right alone": ((RADIUS,), says("named", RIGHT), YES, NO, (), 9, 0, (), R),
    "right, and its interval holds the truth": (
        (RADIUS,), says("named", cause(R, [3], **values(scale=WIDE))), YES, NO, (), 9, 0, YES, R),
    "right, and its interval does not": (
        (RADIUS,), says("named", cause(R, [3], **values(scale=NARROW))), YES, NO, (), 9, 0, NO, R),
    "right beside something unexplained": (
        (RADIUS,), says("unexplained", RIGHT), YES, NO, (), 9, 0, (), R),
    "right first, with rivals": (
        (RADIUS,), says("ambiguous", cause(R, [3], L)), NO, YES, (), 9, 0, (), "ambiguous"),
    "right first, with rivals, though the verdict is named": (
        (RADIUS,), says("named", cause(R, [3], L)), NO, YES, (), 9, 0, (), "ambiguous"),
    "right first, with rivals, beside something unexplained": (
        (RADIUS,), says("unexplained", cause(R, [3], L)), NO, YES, (), 9, 0, (), "ambiguous"),
    "right, but as a rival": (
        (RADIUS,), says("ambiguous", cause(L, [3], R)), NO, YES, (), 9, 0, (), "ambiguous"),
    "right, but not relied on": (
        (RADIUS,), says("unexplained", cause(R, [3], exported=False)),
        NO, YES, (), 9, 0, (), "ambiguous"),
    "right, and relied on": (
        (RADIUS,), says("named", cause(R, [3], exported=True)), YES, NO, (), 9, 0, (), R),
    "wrong": ((RADIUS,), says("named", cause(L, [3])), NO, NO, (L,), 9, 0, (), L),
    "wrong, and not relied on": (
        (RADIUS,), says("unexplained", cause(L, [3], exported=False)), NO, NO, (L,), 9, 0, (), L),
    "wrong, with wrong rivals": (
        (RADIUS,), says("ambiguous", cause(L, [3], "clock_offset")), NO, NO, (L,), 9, 0, (), L),
    "wrong beside right": (
        (RADIUS,), says("named", RIGHT, cause(L, [3])), YES, NO, (L,), 9, 0, (), L),
    "wrong beside right, of a healthy robot": (
        (RADIUS,), says("named", RIGHT, cause(L, [8])), YES, NO, (L,), 9, 1, (), L),
    "right, of the wrong robot": (
        (RADIUS,), says("named", cause(R, [4])), NO, NO, (R,), 9, 1, (), R),
    "right, of a healthy robot as well": (
        (RADIUS,), says("named", cause(R, [3, 4])), NO, YES, (R,), 9, 1, (), R),
    "right, of one of two that have it": (
        (TWO,), says("named", cause(R, [3])), NO, YES, (), 8, 0, (), "ambiguous"),
    "right, of both that have it": (
        (TWO,), says("named", cause(R, [3, 4])), YES, NO, (), 8, 0, (), R),
    "right, of no robot": ((RADIUS,), says("named", cause(R, [])), NO, NO, (R,), 9, 0, (), R),
    "right wheel": (
        (LEFT,), says("named", cause(LEFT.name, [3], **values(wheel="left"))),
        YES, NO, (), 9, 0, (), LEFT.name),
    "wrong wheel": (
        (LEFT,), says("named", cause(LEFT.name, [3], **values(wheel="right"))),
        NO, NO, (LEFT.name,), 9, 0, (), LEFT.name),
    "wrong wheel, with rivals": (
        (LEFT,), says("ambiguous", cause(LEFT.name, [3], L, **values(wheel="right"))),
        NO, NO, (LEFT.name,), 9, 0, (), LEFT.name),
    "right sensor": (
        (DEAD,), says("named", cause(DEAD.name, [3], **values(sensor="5"))),
        YES, NO, (), 9, 0, (), DEAD.name),
    "wrong sensor": (
        (DEAD,), says("named", cause(DEAD.name, [3], **values(sensor="6"))),
        NO, NO, (DEAD.name,), 9, 0, (), DEAD.name),
    "one robot's fault said of the swarm": (
        (RADIUS,), says("named", cause(R, ALL)), NO, YES, (R,), 9, 9, (), R),
    "the swarm's fault": ((SWARM,), says("named", cause(R, ALL)), YES, NO, (), 0, 0, (), R),
    "the swarm's fault, said of eight of ten": (
        (SWARM,), says("named", cause(R, [*range(8)])), YES, NO, (), 0, 0, (), R),
    "the swarm's fault, said of seven of ten": (
        (SWARM,), says("named", cause(R, [*range(7)])), NO, YES, (), 0, 0, (), "ambiguous"),
    "the place": (
        (PLACE,), says("named", cause(PLACE.name, ALL)), YES, NO, (), 0, 0, (), PLACE.name),
    "the place, with rivals": (
        (PLACE,), says("ambiguous", cause(PLACE.name, ALL, "lamp_height")),
        NO, YES, (), 0, 0, (), "ambiguous"),
    "a robot's fault for the place": (
        (PLACE,), says("named", cause(R, [3])), NO, NO, (R,), 0, 0, (), R),
    "the place for a robot's fault": (
        (RADIUS,), says("named", cause(PLACE.name, ALL)),
        NO, NO, (PLACE.name,), 9, 9, (), PLACE.name),
    "ill, and said to be well": (
        (RADIUS,), says("nothing_wrong"), NO, NO, (), 9, 0, (), "nothing_wrong"),
    "ill, and only unexplained": (
        (RADIUS,), says("unexplained"), NO, NO, (), 9, 0, (), "unexplained"),
    "ill, and the log cannot tell": (
        (RADIUS,), says("cannot_tell"), NO, NO, (), 0, 0, (), "cannot_tell"),
    "ill, and the diagnosis failed": ((RADIUS,), None, NO, NO, (), 9, 0, (), "failed"),
    "well": ((), says("nothing_wrong"), (), (), (), 10, 0, (), "nothing_wrong"),
    "well, and the log cannot tell": (
        (), says("cannot_tell"), (), (), (), 0, 0, (), "cannot_tell"),
    "well, and the log cannot tell, but accuses": (
        (), says("cannot_tell", cause(L, [2])), (), (), (L,), 10, 1, (), L),
    "well, and unexplained": ((), says("unexplained"), (), (), (), 10, 0, (), "unexplained"),
    "well, and accused": (
        (), says("named", cause(L, [2]), cause(L, [5])), (), (), (L, L), 10, 2, (), L),
    "well, and accused with rivals": (
        (), says("ambiguous", cause(L, [2], R)), (), (), (L,), 10, 1, (), L),
    "well, and the swarm accused": (
        (), says("named", cause(R, ALL)), (), (), (R,), 10, 10, (), R),
    "well, and the diagnosis failed": ((), None, (), (), (), 10, 0, (), "failed"),
    "without a name, and named": (
        (STRANGE,), says("named", cause(L, [3])), NO, NO, (L,), 9, 0, (), L),
    "without a name, and unexplained": (
        (STRANGE,), says("unexplained"), NO, NO, (), 9, 0, (), "unexplained"),
}  # fmt: skip


@pytest.mark.parametrize("kind", TABLE)
def test_every_kind_of_answer_has_its_score(kind: str) -> None:
    hidden, answer, right, among, wrong, healthy, accused, inside, word = TABLE[kind]
    verdict = "failed" if answer is None else answer["verdict"]
    found = score(trial(*hidden), answer)
    assert found == Score(verdict, right, among, wrong, healthy, accused, inside)
    assert outcome(trial(*hidden), found) == word


@pytest.mark.parametrize("kind", TABLE)
def test_what_has_rivals_or_is_not_relied_on_is_never_named(kind: str) -> None:
    """Whatever the answer, doubt added to each of its causes leaves nothing named."""
    hidden, answer, *_ = TABLE[kind]
    for doubt in ({"alternatives": ["speed_droop"]}, {"exported": False}):
        for verdict in ("named", "ambiguous", "unexplained"):
            causes = [{**one, **doubt} for one in (answer or {"causes": []})["causes"]]
            found = score(trial(*hidden), {"verdict": verdict, "causes": causes})
            assert not any(found.right)
            assert found.exact is (not hidden and not found.wrong and not found.accused)


@pytest.mark.parametrize(
    ("causes", "exact"),
    [
        ((RIGHT, cause(L, [4])), True),
        ((RIGHT,), False),
        ((RIGHT, cause(L, [4]), cause("speed_droop", [3])), False),
        ((RIGHT, cause(L, [4]), cause("speed_droop", [8])), False),
        ((RIGHT, cause(L, [4], R)), False),
        ((RIGHT, cause(L, [4], exported=False)), False),
        ((RIGHT, cause(L, [3])), False),
        ((cause(R, [4]), cause(L, [3])), False),
        ((), False),
    ],
)
def test_a_pair_is_exact_only_if_both_are_named_of_their_robots_and_nothing_else(
    causes: tuple[dict[str, Any], ...], exact: bool
) -> None:
    assert score(trial(RADIUS, LAG), says("named", *causes)).exact is exact


def test_two_effects_in_one_robot_are_a_pair_like_any_other() -> None:
    both = trial(RADIUS, replace(LAG, robots=(3,)))
    assert score(both, says("named", RIGHT, cause(L, [3]))).exact
    half = score(both, says("named", RIGHT))
    assert (half.right, half.wrong, half.exact) == ((True, False), (), False)


def test_robots_that_share_a_cause_must_all_have_it_or_it_is_wrong() -> None:
    crowd = trial(RADIUS, replace(RADIUS, robots=(5,)))
    assert score(crowd, says("named", cause(R, [3, 5]))).wrong == ()
    assert score(crowd, says("named", cause(R, [3, 5, 6]))).wrong == (R,)


def test_of_what_has_no_name_only_the_verdict_unexplained_flags_it() -> None:
    answers = [
        says("unexplained"),
        says("unexplained", cause(L, [3])),
        says("named", cause(L, [3])),
        says("nothing_wrong"),
        says("cannot_tell"),
        None,
    ]
    scored = [(score(trial(STRANGE, kind="unlisted"), one), False) for one in answers]
    found = unknowns(scored)
    assert found["flagged_unexplained"]["hits"] == 2
    assert found["wrong_name_alone"]["hits"] == 1


def test_of_a_crowd_a_log_that_cannot_tell_acquits_no_robot() -> None:
    said = {**says("cannot_tell", cause(L, [2])), "unexplained": []}
    assert of_robots(said, {3})["verdict"] == "cannot_tell"
    assert score(trial(), of_robots(said, {3})).healthy == 0
    assert of_robots(says("named", cause(L, [2])), {3})["verdict"] == "nothing_wrong"


def test_every_verdict_without_a_name_counts_as_abstaining() -> None:
    words = {word for *_, word in TABLE.values()}
    names = {R, L, LEFT.name, DEAD.name, PLACE.name}
    assert words - names == set(ABSTAINED)

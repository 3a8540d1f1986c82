"""A lamp that stands somewhere else altogether is found, and nothing else is blamed for it."""

from __future__ import annotations

import numpy as np
import pytest

from realitygap.models.belief.senses import Belief
from realitygap.models.log.measured import make_log
from realitygap.models.log.schema import LS
from realitygap.models.naming.channels.senses.leap import far_lamps
from realitygap.models.naming.channels.senses.sight import look
from realitygap.models.naming.channels.senses.terms import Doses
from tests.models.naming.test_senses import (
    HEALTHY,
    MODEL,
    ROBOTS,
    examined,
    names,
    table,
    with_senses,
)

FAR = [
    ("lamp_moved", {"x": -1.0, "y": 0.4}),
    ("lamp_moved", {"x": -0.2, "y": 0.75}),
    ("lamp_moved", {"x": 0.9, "y": -0.8}),
    ("second_lamp", {"x": 0.1, "y": 0.05, "intensity": 1.5}),
    ("second_lamp", {"x": -1.0, "y": -0.9, "intensity": 5.0}),
]


def believed(name: str, values: dict[str, float]) -> Belief:
    """What makes a robot read as under this lamp."""
    if name == "lamp_moved":
        return with_senses(lamp_shift=tuple(values.values()))
    return with_senses(second_lamp=tuple(values.values()))


@pytest.mark.parametrize(("name", "values"), FAR[::2])
def test_it_is_named_alone_with_its_place(name: str, values: dict[str, float]) -> None:
    found = examined(table({}, everybody=believed(name, values)))
    assert names(found) == [(name, "", "all")]
    assert not found.named[0].evidence.rivals
    assert not found.unexplained
    for told in found.named[0].values:
        assert told.low <= values[told.name] <= told.high


def doses(belief: Belief) -> Doses:
    sight = look(make_log(table({}, everybody=belief), drive=MODEL.drive), MODEL)
    return far_lamps(sight, MODEL, [HEALTHY] * ROBOTS)


@pytest.mark.parametrize(("name", "values"), FAR)
def test_a_few_moments_tell_its_place_to_a_tenth(name: str, values: dict[str, float]) -> None:
    found = doses(believed(name, values))
    (places,) = [places for term, places in found.items() if term.cause.name == name]
    away = np.array(list(values.values()))
    off = [np.abs(place - away).max() for place in places]
    assert min(off) < 0.1 * max(1.0, float(np.abs(away).max()))


def test_it_is_not_looked_for_where_light_is_nearly_as_expected() -> None:
    assert not doses(with_senses(lamp_shift=(0.005, 0.0)))


def test_light_that_hardly_anybody_sees_is_the_lamps_and_a_covered_sensor_is_its_own() -> None:
    frame = table({}, everybody=believed("lamp_moved", {"x": 1.1, "y": 1.0}))
    assert names(examined(frame)) == [("lamp_moved", "", "all")]
    frame.loc[frame["robot"] == 3, "ls2"] = 4095.0
    assert names(examined(frame)) == [("lamp_moved", "", "all"), ("ls_dead_sensor", "2", (3,))]


@pytest.mark.parametrize(
    ("share", "dead"),
    [pytest.param(0.5, False, marks=pytest.mark.slow), (0.001, True)],
)
def test_a_sensor_that_has_seen_light_is_not_dead(share: float, dead: bool) -> None:
    frame = table({})
    mine = np.flatnonzero(frame["robot"] == 3)
    frame.loc[mine, "ls2"] = 4095.0
    seen = mine[: round(share * len(mine))]
    frame.loc[seen, "ls2"] = MODEL.tables.ls_dark - 300.0
    assert (("ls_dead_sensor", "2", (3,)) in names(examined(frame))) == dead


def test_where_all_sensors_read_dark_none_of_them_is_dead() -> None:
    frame = table({})
    frame[list(LS)] = MODEL.tables.ls_dark
    assert not [one for one in names(examined(frame)) if one[0] == "ls_dead_sensor"]

"""What no cause explains in the readings is reported with the quantity that it follows."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.models.belief.catalogue import without
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.channels.senses.diagnose import SenseExamination
from realitygap.models.naming.diagnosis import Unexplained
from tests.models.naming.test_senses import MODEL, examined, names, table, with_senses


def left(found: SenseExamination) -> list[tuple[str, str, object]]:
    return [(one.channel, one.quantity, one.robots) for one in found.unexplained]


def dimmed(frame: pd.DataFrame, share: np.ndarray) -> pd.DataFrame:
    """A log whose lamps give this much more light."""
    assert MODEL.tables is not None
    dark = MODEL.tables.ls_dark
    lit = frame[list(LS)].to_numpy()
    frame[list(LS)] = np.rint(dark - (dark - lit) * (1.0 + share)[:, None])
    return frame


def test_nothing_is_left_where_everything_reads_as_simulated_or_is_named() -> None:
    assert left(examined(table({}))) == []
    assert left(examined(table({}, everybody=with_senses(lamp_intensity=0.95)))) == []


def test_a_lamp_that_swings_is_left_as_following_time_and_named_nothing() -> None:
    frame = table({})
    found = examined(dimmed(frame, 0.08 * np.sin(2.0 * np.pi * frame["t"].to_numpy() / 12.0)))
    assert left(found) == [("light", "time", "all")]
    assert names(found) == []
    assert "a swing of 12.0 s" in found.unexplained[0].where
    assert 0.01 < found.unexplained[0].share < 1.0


def test_infrared_from_one_side_is_left_as_following_where_the_sensor_looks() -> None:
    frame = table({})
    looks = frame["yaw"].to_numpy()[:, None] + np.array(MODEL.sensor_angles)
    frame[list(PS)] += np.rint(15.0 * np.maximum(np.cos(looks - 0.7), 0.0))
    found = examined(frame)
    assert left(found) == [("infrared", "heading", "all")]
    assert names(found) == []


def test_what_one_robot_has_is_left_for_that_robot() -> None:
    frame = table({})
    mine = (frame["robot"] == 2).to_numpy()
    swing = 0.1 * np.sin(2.0 * np.pi * frame["t"].to_numpy() / 12.0)
    found = examined(dimmed(frame, np.where(mine, swing, 0.0)))
    assert [one.robots for one in found.unexplained] == [(2,)]
    assert found.unexplained[0].quantity == "time"


def test_a_named_cause_stands_beside_what_it_does_not_explain() -> None:
    frame = table({}, everybody=with_senses(lamp_intensity=0.9))
    swing = 0.04 * np.sin(2.0 * np.pi * frame["t"].to_numpy() / 8.0)
    found = examined(dimmed(frame, swing))
    assert names(found) == [("lamp_intensity", "", "all")]
    assert left(found) == [("light", "time", "all")]


@pytest.mark.parametrize(
    ("name", "quantities", "changes"),
    [
        ("ir_rotation", {"bearing"}, {"rotation": 0.08}),
        ("ir_offset", {"always"}, {"ps_offset": (6.0,) * 8}),
        ("ir_noise", {"noise"}, {"ps_noise": 2.0}),
        ("light_gamma", {"always", "level", "distance"}, {"light_gamma": 1.1}),
    ],
)
def test_a_fault_whose_cause_is_withheld_is_left_unexplained(
    name: str, quantities: set[str], changes: dict[str, object]
) -> None:
    with without((name,)):
        found = examined(table({2: with_senses(**changes)}))
    assert name not in {one.term.cause.name for one in found.named}
    mine: list[Unexplained] = [one for one in found.unexplained if one.robots == (2,)]
    assert {one.quantity for one in mine} & quantities
    assert examined(table({2: with_senses(**changes)})).named


def test_a_cause_that_only_mimics_a_withheld_one_is_not_named_alone() -> None:
    with without(("lamp_intensity",)):
        found = examined(table({}, everybody=with_senses(lamp_intensity=0.9)))
    assert ("light", "all") in [(one.channel, one.robots) for one in found.unexplained]

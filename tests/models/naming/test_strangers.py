"""What nobody logged silences the senses; one faulty robot does not."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import Drive, PointModel
from realitygap.models.log.measured import MeasuredLog, make_log
from realitygap.models.log.schema import LS, PS
from realitygap.models.naming.strangers import without_strangers
from tests.models.small import arena_log, tables

MODEL = PointModel(tables=tables())


def frame() -> pd.DataFrame:
    return arena_log(2, robots=3, rows=900)


def seeing(log: pd.DataFrame, robots: tuple[int, ...]) -> pd.DataFrame:
    """Some robots' infrared meets somebody now and then, in the middle of the arena too."""
    rng = np.random.default_rng(np.random.SeedSequence(6))
    met = log["robot"].isin(robots).to_numpy() & (rng.uniform(size=len(log)) < 0.02)
    changed = log.copy()
    changed.loc[met, "ps0"] += 800.0
    return changed


def asked(log: pd.DataFrame, model: PointModel = MODEL) -> tuple[MeasuredLog, dict[str, str]]:
    found, entries = without_strangers(make_log(log, drive=Drive()), model)
    return found, {one.name: one.follows for one in entries}


def test_a_log_of_all_robots_is_left_as_it_is() -> None:
    log = make_log(frame(), drive=Drive())
    found, entries = without_strangers(log, MODEL)
    assert found is log
    assert {one.name: one.value for one in entries}["strangers"] == 0.0


def test_what_most_robots_see_and_nobody_logged_silences_infrared_and_light() -> None:
    found, follows = asked(seeing(frame(), (0, 1, 2)))
    assert not set(found.frame.columns) & {*PS, *LS}
    assert follows["strangers"] == follows["infrared"] == follows["light"] == "silences"
    assert any("infrared sees what is neither" in note for note in found.notes)


@pytest.mark.parametrize("change", ["sees", "gain", "offset", "noise", "dead"])
def test_one_faulty_robot_silences_nobody(change: str) -> None:
    log = frame()
    mine = log["robot"] == 1
    rng = np.random.default_rng(np.random.SeedSequence(7))
    noise = rng.uniform(-20.0, 20.0, (int(mine.sum()), 8))
    if change == "sees":
        log = seeing(log, (1,))
    elif change == "noise":
        log.loc[mine, list(PS)] = np.clip(log.loc[mine, list(PS)] + noise, 0.0, 4095.0)
    else:
        factor = {"gain": 3.0, "offset": 1.0, "dead": 0.0}[change]
        log.loc[mine, list(PS)] = factor * log.loc[mine, list(PS)] + 50.0 * (change == "offset")
    found, follows = asked(log)
    assert set(PS) <= set(found.frame.columns)
    assert follows["strangers"] == "nothing"


def test_a_wall_that_is_not_where_the_model_has_it_silences_them_too() -> None:
    small = PointModel(tables=tables(), arena_radius=0.4, nest=(0.2, 0.0, 0.1))
    found, follows = asked(frame(), small)
    assert not set(found.frame.columns) & set(PS)
    assert follows["wall_missed"] == "silences"


def test_a_log_whose_senses_are_silenced_is_not_said_to_lack_them() -> None:
    log = make_log(seeing(frame(), (0, 1, 2)).drop(columns=list(LS)), drive=Drive())
    told = {one.name: one for one in without_strangers(log, MODEL)[1]}
    assert told["infrared"].value is True
    assert "not judged" in told["infrared"].why
    assert "ir_gain" in told["infrared"].causes
    assert "light" not in told


def test_without_infrared_nothing_is_said() -> None:
    found, follows = asked(frame().drop(columns=list(PS)))
    assert set(LS) <= set(found.frame.columns)
    assert follows == {"strangers": "nothing", "wall_missed": "nothing"}

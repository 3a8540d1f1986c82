"""How a table is written changes nothing of what is said of it, to the printed digits."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import pytest

import realitygap as rg
from realitygap.models.log.measured import read_table
from tests.golden.answers import log_file, rounded

BOTH = "pair-wheel_radius_mismatch-ir_gain"
"""Three robots, 50 s, two causes in one of them: one in motion and one in infrared."""
FILES = ("inputs", "versions", "next_experiment")
"""Keys that name files and programs."""


@cache
def frame(name: str) -> pd.DataFrame:
    return read_table(log_file(name))


def said(table: pd.DataFrame, recorder: str) -> dict[str, Any]:
    table.attrs["recorder"] = recorder
    content = {k: v for k, v in rg.diagnose(table).content.items() if k not in FILES}
    text: dict[str, Any] = rounded(content)
    return text


@cache
def kept(recorder: str, name: str = BOTH) -> dict[str, Any]:
    return said(frame(name).copy(), recorder)


def reordered(table: pd.DataFrame) -> pd.DataFrame:
    return pd.concat([table[table["robot"] == robot] for robot in (2, 0, 1)], ignore_index=True)


def row_by_row(table: pd.DataFrame) -> pd.DataFrame:
    return table.sort_values(["t", "robot"], ignore_index=True)


def permuted(table: pd.DataFrame) -> pd.DataFrame:
    rng = np.random.default_rng(np.random.SeedSequence(3))
    return table[list(rng.permutation(table.columns))]


def renamed(table: pd.DataFrame) -> pd.DataFrame:
    return table.assign(run="another")


@pytest.mark.parametrize("recorder", ["reality pybullet", ""])
@pytest.mark.parametrize("change", [reordered, row_by_row, permuted, renamed])
def test_what_is_said_does_not_depend_on_how_a_table_is_written(
    change: Callable[[pd.DataFrame], pd.DataFrame], recorder: str
) -> None:
    assert [one["name"] for one in kept(recorder)["causes"]]
    assert said(change(frame(BOTH).copy()), recorder) == kept(recorder)


@pytest.mark.parametrize("name", ["single-motor_lag", "single-lamp_moved"])
@pytest.mark.parametrize("seconds", [1000.0, 1003.7])
def test_what_is_said_does_not_depend_on_when_time_began(name: str, seconds: float) -> None:
    log = frame(name)
    assert said(log.assign(t=log["t"] + seconds), "") == kept("", name)


def test_where_a_tracker_has_its_origin_and_axes_changes_no_name() -> None:
    log = frame(BOTH)
    turn, x, y = np.radians(110.0), 2.0, -0.7
    c, s = np.cos(turn), np.sin(turn)
    there = log.assign(
        x=c * log["x"] - s * log["y"] + x,
        y=s * log["x"] + c * log["y"] + y,
        yaw=(log["yaw"] + turn + np.pi) % (2 * np.pi) - np.pi,
    )
    found, usual = said(there, ""), kept("")
    assert found["verdict"] == usual["verdict"]
    assert [(one["name"], one["robots"]) for one in found["causes"]] == [
        (one["name"], one["robots"]) for one in usual["causes"]
    ]
    entries = {one["name"]: one for one in found["log"]["preflight"]}
    assert entries["frame_turn"]["follows"] == "repaired"
    unseen = entries["frame_turn"]  # a log without light and nest does not show its turn
    assert unseen["high"] - unseen["low"] > 6.0
    assert entries["frame_x"]["value"] == pytest.approx(x, abs=0.005)
    assert entries["frame_y"]["value"] == pytest.approx(y, abs=0.005)
    usually = {one["name"]: one for one in usual["log"]["preflight"]}
    assert usually["frame_turn"]["value"] is None

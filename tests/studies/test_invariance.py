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

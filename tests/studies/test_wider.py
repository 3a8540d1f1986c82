"""What robots believe of a wider arena, and runs in one."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.models import load_model
from realitygap.reality.arena import ForagingArena
from realitygap.studies.run.wider import widened
from tests.helpers import realitygap


def test_the_nominal_arena_leaves_a_model_as_it_is() -> None:
    model = load_model()
    assert widened(model, ForagingArena()) is model


def test_nest_and_lamps_move_out_and_the_rest_stays() -> None:
    model = load_model()
    wide = widened(model, ForagingArena(1.2))
    assert wide.arena_radius == pytest.approx(1.2)
    assert wide.nest == pytest.approx((1.1, 0.0, 0.2))
    assert wide.lamps == ((-1.2, 0.0), None, (1.2, 0.0))
    assert wide.food_items == 28
    changed = {"arena_radius", "nest", "lamps", "food_items"}
    for one in fields(model):
        same = getattr(wide, one.name) is getattr(model, one.name)
        assert same or one.name in changed or getattr(wide, one.name) == getattr(model, one.name)
    assert wide.struct.arena_radius == pytest.approx(1.2)  # C takes it


def test_what_a_model_has_wrong_stays_wrong() -> None:
    model = replace(load_model(), nest=(0.3, 0.4, 0.15), arena_radius=0.58)
    wide = widened(model, ForagingArena(1.6))
    assert wide.nest == pytest.approx((0.9, 1.2, 0.15))  # 1 m further on the same bearing
    assert wide.arena_radius == pytest.approx(1.58)


def test_a_state_holds_so_much_food_and_no_more() -> None:
    assert widened(load_model(), ForagingArena(6.0)).food_items == 32


def test_a_run_in_a_wider_arena_uses_all_of_it(tmp_path: Path) -> None:
    out = tmp_path / "run"
    words = ("run", "--robots", 30, "--arena-radius", 1.5, "--minutes", 0.3)
    done = realitygap(*words, "--out", out)
    assert done.returncode == 0, done.stderr
    assert json.loads((out / "run.json").read_text())["config"]["arena_radius"] == 1.5
    samples = pd.read_parquet(out / "samples.parquet")
    assert samples["robot"].nunique() == 30
    far = np.hypot(samples["x"], samples["y"])
    assert 1.2 < far.max() < 1.5 - 0.03


@pytest.mark.parametrize("radius", [0.3, 11, "nan"])
def test_no_other_arena_than_a_wider_one_is_taken(radius: object, tmp_path: Path) -> None:
    done = realitygap("run", "--arena-radius", radius, "--out", tmp_path / "run")
    assert done.returncode == 2
    assert "--arena-radius: got" in done.stderr

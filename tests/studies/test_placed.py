"""A log whose tracker has axes of its own is read in the frame of the model's arena, everywhere."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import realitygap as rg
from realitygap.studies.diagnosis.tracks import worst_tracks

TURN = np.radians(37.0)
FAULT = ("wheel_radius_mismatch:ratio=1.03,robot=1",)


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[pd.DataFrame, pd.DataFrame]:
    """A run's log, and what a tracker turned by 37 degrees would have written of it."""
    room = tmp_path_factory.mktemp("placed")
    rg.simulate(minutes=0.7, robots=2, seed=5, controller="search", effects=FAULT, out=room / "run")
    log = pd.read_parquet(room / "run" / "samples.parquet")
    log.attrs = {}  # nobody says what recorded it
    c, s = np.cos(TURN), np.sin(TURN)
    turned = log.assign(
        x=c * log["x"] - s * log["y"], y=s * log["x"] + c * log["y"], yaw=log["yaw"] + TURN
    )
    return log, turned


def test_what_is_told_and_drawn_of_a_turned_log_lies_in_the_arena(
    pair: tuple[pd.DataFrame, pd.DataFrame],
) -> None:
    straight, turned = pair
    found = rg.diagnose(turned)
    told = found.preflight.set_index("name")["value"]
    assert told["frame_turn"] == pytest.approx(TURN, abs=0.02)
    there = found.log.table.merge(straight, on=["robot", "t"], suffixes=("", "_true"))
    apart = np.hypot(there["x"] - there["x_true"], there["y"] - there["y_true"])
    assert apart.max() < 0.02
    seen = worst_tracks(found.log.measured, found.examined.model, found.extended.file, set())
    assert seen is not None
    at = seen.table[["measured_x", "measured_y"]].to_numpy()
    assert np.hypot(*at.T).max() < 0.6
    near = straight[straight["robot"] == seen.robot].set_index("t").loc[seen.table["t"]]
    assert np.hypot(*(at - near[["x", "y"]].to_numpy()).T).max() < 0.02
    lines = found.plot().get_lines()
    drawn = np.column_stack(
        [np.concatenate([line.get_data()[k] for line in lines]) for k in (0, 1)]
    )
    assert np.hypot(*(drawn - at.mean(axis=0)).T).max() < 1.2


@pytest.mark.slow
def test_a_gap_and_a_gain_place_it_and_say_so(
    pair: tuple[pd.DataFrame, pd.DataFrame],
) -> None:
    straight, turned = pair
    light = {}
    for name, log in {"straight": straight, "turned": turned}.items():
        gap = rg.measure_gap(log)
        notes = gap.content["log"]["notes"]
        assert any("degrees about" in note for note in notes) == (name == "turned")
        light[name] = gap.channels.query("kind == 'ls'")["rms"].to_numpy()
    assert len(light["straight"]) == 8
    assert light["turned"] == pytest.approx(light["straight"], rel=0.3)
    named = rg.diagnose(straight)
    assert len(named.causes)
    gain = rg.gain(turned, named.extended, jobs=1)
    assert any("degrees about" in line for line in gain.summary)
    errors = pd.DataFrame(gain.content["errors"]).query("channel.str.match('ls[0-7]')")
    assert len(errors) == 8
    assert max(one["value"] for one in errors["before"]) < 1.3 * light["straight"].max()

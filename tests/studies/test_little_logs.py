"""Logs of one or two robots, of seconds, or resampled."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import realitygap as rg
from realitygap.models.belief.modelfile import read_model_file
from realitygap.studies.run.experiment import RunConfig, simulate
from tests.helpers import realitygap


def recorded(out: Path, *specs: str, robots: int, minutes: float, case: str = "no-light") -> Path:
    """A run of searching robots with this hidden in it."""
    out.mkdir()
    config = RunConfig.model_validate(
        {"case": case, "controller": "search", "robots": robots, "minutes": minutes, "seed": 1}
    )
    simulate(config, specs, out)
    return out


def diagnosed(log: Path, out: Path) -> dict[str, Any]:
    """What is written of a log; numbers alone, and an extension that can be read."""

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} in diagnosis.json")

    rg.diagnose(log, out=out)
    read_model_file(out / "extended.toml")
    content: dict[str, Any] = json.loads(
        (out / "diagnosis.json").read_text(encoding="utf-8"), parse_constant=refuse
    )
    return content


@pytest.mark.parametrize("robots", [1, 2, 3])
def test_a_brighter_lamp_is_the_places_however_many_robots_see_it(
    robots: int, tmp_path: Path
) -> None:
    run = recorded(
        tmp_path / "run", "lamp_intensity:scale=3", robots=robots, minutes=0.5, case="light-at-nest"
    )
    found = diagnosed(run, tmp_path / "out")
    assert [(c["name"], c["robots"]) for c in found["causes"]] == [("lamp_intensity", "all")]


def test_noise_in_seconds_of_a_log_is_told_in_numbers(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run", "ir_noise:scale=4", robots=10, minutes=0.2)
    found = diagnosed(run, tmp_path / "out")
    assert found["causes"][0]["name"] == "ir_noise"


@pytest.mark.parametrize("command", ["gap", "diagnose"])
def test_of_seconds_of_a_log_no_library_says_a_word(command: str, tmp_path: Path) -> None:
    run = recorded(tmp_path / "run", robots=3, minutes=0.05, case="light-at-nest")
    done = realitygap(command, run, "--quiet", "--out", tmp_path / "out")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def resampled(log: pd.DataFrame, rate: float) -> pd.DataFrame:
    """A log of one run at another rate (Hz): poses interpolated, commands and sensors held."""
    parts = []
    for _, one in log.groupby("robot"):
        t = one["t"].to_numpy()
        new = np.arange(t[0], t[-1], 1.0 / rate)
        held = one.iloc[np.searchsorted(t, new, side="right") - 1].copy()
        poses = {"x": one["x"], "y": one["y"], "yaw": np.unwrap(one["yaw"])}
        parts.append(
            held.assign(t=new, **{name: np.interp(new, t, v) for name, v in poses.items()})
        )
    return pd.concat(parts, ignore_index=True)


@pytest.mark.slow
def test_a_log_resampled_to_20_hz_is_diagnosed(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run", robots=3, minutes=0.5, case="light-at-nest")
    log = resampled(pd.read_parquet(run / "samples.parquet"), 20.0)
    log.to_parquet(tmp_path / "log.parquet")
    found = diagnosed(tmp_path / "log.parquet", tmp_path / "out")
    assert found["robots"] == [0, 1, 2]

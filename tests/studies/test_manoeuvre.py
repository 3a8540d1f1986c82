"""`realitygap run --controller probe:NAME`: manoeuvres in reality."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim import PointModel
from realitygap.embedded_sim.pilot import fly
from realitygap.embedded_sim.probes import MENU
from realitygap.studies.run.experiment import RunConfig, simulate
from tests.helpers import realitygap


def run(out: Path, name: str, *effects: str, **config: object) -> pd.DataFrame:
    out.mkdir()
    given = {"minutes": 0.25, "robots": 3, "seed": 5, **config}
    simulate(RunConfig.model_validate({"controller": f"probe:{name}", **given}), effects, out)
    return pd.read_parquet(out / "samples.parquet")


def test_a_run_writes_what_any_run_writes_and_nothing_is_deposited(tmp_path: Path) -> None:
    done = realitygap(
        *("run", "--controller", "probe:square", "--minutes", 0.2, "--robots", 2),
        *("--effect", "wheel_separation:scale=1.05,robot=1", "--out", tmp_path / "run"),
    )
    assert done.returncode == 0, done.stderr
    names = {path.name for path in (tmp_path / "run").iterdir()}
    tables = {"samples.parquet", "generations.parquet", "deposits.parquet"}
    assert names == {"run.json", "truth.json", *tables}
    assert pd.read_parquet(tmp_path / "run" / "generations.parquet").empty
    assert pd.read_parquet(tmp_path / "run" / "deposits.parquet").empty
    samples = pd.read_parquet(tmp_path / "run" / "samples.parquet")
    assert sorted(samples["robot"].unique()) == [0, 1]
    config = json.loads((tmp_path / "run" / "run.json").read_text())["config"]
    assert config["controller"] == "probe:square"
    assert "wheel_separation" not in (tmp_path / "run" / "run.json").read_text()


@pytest.mark.parametrize("name", ["spins", "tour"])
def test_robots_do_in_reality_what_was_planned(name: str, tmp_path: Path) -> None:
    samples = run(tmp_path / "run", name)
    planned, _ = fly(MENU[name], 3, PointModel(), 375)
    first = planned[0]
    begin = samples[samples["t"] == 0.0]
    np.testing.assert_allclose(begin[["x", "y"]], first[:, :2], atol=5e-3)
    for robot in range(3):
        mine = samples[samples["robot"] == robot]
        off = np.hypot(*(mine[["x", "y"]].to_numpy() - planned[:, robot, :2]).T)
        assert np.median(off) < 0.03


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    a, b = (run(tmp_path / name, "steps", minutes=0.1) for name in "ab")
    pd.testing.assert_frame_equal(a, b)
    same = [(tmp_path / name / "samples.parquet").read_bytes() for name in "ab"]
    assert same[0] == same[1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--controller", "probe:strait"), "did you mean probe:straights"),
        (("--controller", "probe:spins", "--robots", "50"), "--robots: got 50, expected at most"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_leaves_nothing(
    words: tuple[str, ...], said: str, tmp_path: Path
) -> None:
    done = realitygap("run", *words, "--minutes", 0.1, "--out", tmp_path / "run")
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.iterdir())

"""`extended.toml` loads wherever a model loads."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pandas as pd
import pytest

from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.belief.modelfile import read_model_file
from realitygap.studies.cli import main
from realitygap.studies.inputs.model import Model

Run = pytest.MonkeyPatch


def realitygap(monkeypatch: Run, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["realitygap", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def extended(room: Path, robots: object, separation: float) -> Path:
    room.mkdir()
    cause = NamedCause(
        name="wheel_separation",
        robots=robots,
        parameters={"scale": ParameterValue(value=separation, low=0.9, high=1.5, unit="1")},
    )
    named = Extension(log="0" * 64, command="realitygap diagnose", causes=(cause,))
    Model.load("epuck").extended(named).keep(room)
    return room / "extended.toml"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One generation of two robots with the minimal model on board."""
    out = tmp_path_factory.mktemp("run") / "run"
    with pytest.MonkeyPatch.context() as patch:
        words = ("run", "--minutes", "2.1", "--robots", "2", "--quiet", "--out", out)
        assert realitygap(patch, *words) == 0
    return out


def tables(run: Path) -> list[bytes]:
    names = ("generations.parquet", "deposits.parquet", "samples.parquet")
    return [(run / name).read_bytes() for name in names]


def test_a_run_with_an_extension_at_its_null_is_the_run_without_bit_for_bit(
    recorded: Path, tmp_path: Path, monkeypatch: Run
) -> None:
    words = ("run", "--minutes", "2.1", "--robots", "2", "--quiet", "--model")
    null, wide = extended(tmp_path / "null", (1,), 1.0), extended(tmp_path / "wide", (1,), 1.5)
    assert realitygap(monkeypatch, *words, null, "--out", tmp_path / "a") == 0
    assert tables(tmp_path / "a") == tables(recorded)
    assert realitygap(monkeypatch, *words, wide, "--out", tmp_path / "b") == 0
    believed = [pd.read_parquet(run / "generations.parquet") for run in (recorded, tmp_path / "b")]
    ours, theirs = (table.set_index(["robot", "generation"]).fitness_sim for table in believed)
    assert ours[0, 1] == theirs[0, 1]
    assert ours[1, 1] != theirs[1, 1]


def test_gap_and_diagnosis_are_measured_from_it(
    recorded: Path, tmp_path: Path, monkeypatch: Run
) -> None:
    wide = extended(tmp_path / "wide", (1,), 1.5)
    for command in ("gap", "diagnose"):
        out = tmp_path / command
        assert realitygap(monkeypatch, command, recorded, "--model", wide, "--out", out) == 0
    errors = pd.read_parquet(tmp_path / "gap" / "horizons.parquet").set_index("horizon")
    heading = errors.loc["1 s"].set_index("robot")["heading_median"]
    assert heading[1] > 3 * heading[0]
    found = json.loads((tmp_path / "diagnose" / "diagnosis.json").read_text())
    narrow = next(c for c in found["causes"] if c["name"] == "wheel_separation")
    assert narrow["robots"] == [1]
    assert narrow["parameters"]["scale"]["value"] == pytest.approx(1 / 1.5, rel=0.02)
    both = read_model_file(tmp_path / "diagnose" / "extended.toml").motion(1)
    assert both.drive.axle == pytest.approx(0.053, rel=0.02)


@pytest.mark.parametrize("command", ["run", "gap", "diagnose", "study", "gain"])
def test_robots_that_do_not_exist_are_refused_everywhere(
    command: str,
    recorded: Path,
    tmp_path: Path,
    monkeypatch: Run,
    capsys: pytest.CaptureFixture[str],
) -> None:
    wrong = extended(tmp_path / "wrong", (7,), 1.1)
    words = {
        "run": ("run", "--robots", "2", "--minutes", "1", "--model", wrong),
        "gap": ("gap", recorded, "--model", wrong),
        "diagnose": ("diagnose", recorded, "--model", wrong),
        "study": ("study", "paper", "--robots", "2", "--model", wrong),
        "gain": ("gain", "--log", recorded, "--extended", wrong),
    }[command]
    out = tmp_path / "out"
    assert realitygap(monkeypatch, *words, "--out", out) == 2
    said = capsys.readouterr().err.strip()
    assert "extended.toml: extension.causes.0.robots: got 7, expected a robot: one of 0, 1" in said
    assert len(said.splitlines()) == 1
    assert not out.exists()

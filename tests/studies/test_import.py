"""`realitygap import`: what a lab has, written as a measured log."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import realitygap as rg
from tests.helpers import ROOT, realitygap
from tests.models.small import driven_log

FRAME = driven_log(3, rows=600, position_noise=5e-4, heading_noise=5e-3)


def lab(room):
    """A table with units in no header, robots by name, written by a spreadsheet."""
    raw = pd.DataFrame(
        {
            "Time [ms]": FRAME["t"] * 1e3,
            "X": FRAME["x"] * 1e3,
            "Y": FRAME["y"] * 1e3,
            "Heading": np.degrees(FRAME["yaw"]),
            "left speed": FRAME["cmd_left"],
            "right speed": FRAME["cmd_right"],
            "Name": FRAME["robot"].map({0: "ann", 1: "bob"}),
        }
    )
    raw.to_csv(room / "lab.csv", index=False, sep=";", decimal=",")
    return room / "lab.csv"


def test_a_csv_without_a_map_is_imported_by_a_guess_that_lies_beside_it(tmp_path):
    source, out = lab(tmp_path), tmp_path / "log.parquet"
    done = realitygap("import", "csv", source, "--out", out)
    assert done.returncode == 0, done.stderr
    written = (tmp_path / "log.map.toml").read_text()
    for line in written.splitlines():
        assert line in done.stdout.splitlines()
    assert 'robot = "Name"' in written
    assert 'x = { from = "X", unit = "mm" }' in written
    table = pd.read_parquet(out)
    assert set(table["robot"]) == {"ann", "bob"}
    assert np.allclose(table["x"], FRAME["x"], atol=1e-6)
    again = tmp_path / "again.parquet"
    done = realitygap("import", "csv", source, "--map", tmp_path / "log.map.toml", "--out", again)
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "again.map.toml").exists()
    pd.testing.assert_frame_equal(pd.read_parquet(again), table)


def test_a_guess_overwrites_no_map_unless_asked(tmp_path):
    source, kept = lab(tmp_path), tmp_path / "log.map.toml"
    kept.write_text('[columns]\nt = "mine"\n')
    done = realitygap("import", "csv", source, "--out", tmp_path / "log.csv")
    assert done.returncode == 2
    assert "log.map.toml" in done.stderr
    assert "mine" in kept.read_text()
    assert not (tmp_path / "log.csv").exists()
    done = realitygap("import", "csv", source, "--force", "--out", tmp_path / "log.csv")
    assert done.returncode == 0, done.stderr
    assert "mine" not in kept.read_text()


def test_a_log_that_is_refused_leaves_the_guess_to_be_corrected(tmp_path):
    raw = FRAME.assign(**{n: FRAME[n] * 1e4 for n in ("x", "y", "cmd_left", "cmd_right")})
    raw.to_csv(tmp_path / "lab.csv", index=False)
    done = realitygap("import", "csv", tmp_path / "lab.csv", "--out", tmp_path / "log.csv")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "or another map than the one guessed" in done.stderr
    assert "log.map.toml (--map)" in done.stderr
    assert (tmp_path / "log.map.toml").exists()
    assert not (tmp_path / "log.csv").exists()


def test_the_guess_is_told_from_python(tmp_path):
    log = rg.read_log(lab(tmp_path), format="csv")
    assert log.robots == ("ann", "bob")
    assert 'robot = "Name"' in log.guessed
    assert rg.read_log(ROOT / "docs" / "example" / "log.csv", format="csv").guessed


def test_names_of_robots_stand_in_every_answer(tmp_path):
    frame = FRAME.assign(robot=FRAME["robot"].map({0: "ann", 1: "bob"}))
    model = ROOT / "docs" / "example" / "robot.toml"
    log = rg.read_log(frame, model=model)
    assert set(rg.measure_gap(log).horizons["robot"]) == {"ann", "bob"}
    assert set(rg.replay(log, horizon=1.0)["robot"]) == {"ann", "bob"}
    found = rg.diagnose(log)
    assert found.content["robots"] == ["ann", "bob"]
    assert list(found.used["robot"]) == ["ann", "bob"]
    assert (
        "ann" in found.sentence or "all robots" in found.sentence or "any robot" in found.sentence
    )
    found.write(tmp_path / "diagnosis")
    extended = rg.Model.load(tmp_path / "diagnosis" / "extended.toml")
    assert extended.file.extension.names == {"ann": 0, "bob": 1}
    later = rg.read_log(frame[frame["robot"] == "bob"], model=extended)
    assert later.robots == ("bob",)
    assert list(later.measured.segments["robot"]) == [1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("import csv lab.csv --map nowhere.toml", "--map: got nowhere.toml"),
        ("import mrclam . --map map.toml", "it is for csv"),
        ("import nonsense lab.csv", "FORMAT: got nonsense"),
        ("import csv none.csv", "none.csv: got No such file"),
    ],
)
def test_wrong_words_are_one_line(tmp_path, words, said):
    lab(tmp_path)
    done = realitygap(*words.split(), "--out", "out.csv", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert said in done.stderr
    assert not (tmp_path / "out.csv").exists()

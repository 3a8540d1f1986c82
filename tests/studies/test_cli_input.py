import os
import subprocess
from pathlib import Path

import pytest

from realitygap.studies.altered import MODEL
from realitygap.studies.cli.say import LONGEST_LINE, say
from realitygap.studies.transfer.beliefs import given_model
from tests.helpers import COMMAND, ENVIRONMENT, realitygap
from tests.models.small import driven_log


def test_a_line_from_outside_is_printed_without_control_characters(capsys):
    say("column a\x1b[31m\nb\udcff is not read" + "x" * 10_000)
    said = capsys.readouterr().out
    assert said.startswith("column a\\x1b[31m\\nb\\udcff is not read")
    assert len(said) == LONGEST_LINE + 1


def test_a_bad_log_read_by_a_worker_is_one_line(tmp_path):
    for name in ("a.csv", "b.csv"):
        driven_log(1, rows=100).assign(t=0.0).to_csv(tmp_path / name, index=False)
    done = realitygap("reference", tmp_path / "a.csv", tmp_path / "b.csv", "--out", tmp_path / "r")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("realitygap: t of robot 0")
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "r").exists()


def test_a_terminal_without_our_letters_gets_escapes(tmp_path):
    words = [*COMMAND, "gap", os.fsencode(tmp_path) + b"/\xff\n.csv", "--out", str(tmp_path / "o")]
    environment = {**ENVIRONMENT, "PYTHONIOENCODING": "ascii:strict"}
    done = subprocess.run(words, env=environment, capture_output=True, check=False, timeout=300)
    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1
    assert b"\\udcff\\n.csv" in done.stderr
    effects = subprocess.run(
        [*COMMAND, "effects"], env=environment, capture_output=True, check=False, timeout=300
    )
    assert (effects.returncode, effects.stderr) == (0, b"")


@pytest.mark.parametrize("name", ["absolute", "above"])
def test_a_given_model_is_kept_with_its_tables_wherever_they_lie(tmp_path, name):
    robots = Path(__file__).parents[2] / "models"
    tables = robots / "captured" / "epuck.npz"
    room = tmp_path / "lab" / "models"
    room.mkdir(parents=True)
    (tmp_path / "lab" / "t.npz").write_bytes(tables.read_bytes())
    given = {"absolute": str(tmp_path / "lab" / "t.npz"), "above": "../t.npz"}[name]
    text = (robots / "robots" / "epuck.toml").read_text()
    line = next(line for line in text.splitlines() if line.startswith("tables"))
    (room / "m.toml").write_text(text.replace(line, f'tables = "{given}"'))
    kept = given_model(str(room / "m.toml"))
    assert set(kept) == {MODEL, "t.npz"}
    assert b'tables = "t.npz"' in kept[MODEL]

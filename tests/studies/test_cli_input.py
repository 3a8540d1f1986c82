import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

from realitygap.studies.cli import app
from realitygap.studies.cli.outcome import LONGEST_LINE, say
from realitygap.studies.run.altered import MODEL
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
    robots = Path(__file__).parents[2] / "models" / "belief"
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


def with_out(command: Any, words: tuple[str, ...] = ()) -> Iterator[list[str]]:
    """The words of every command that writes to `--out`."""
    if any("--out" in one.opts for one in command.params):
        yield list(words)
    for name, inner in getattr(command, "commands", {}).items():
        yield from with_out(inner, (*words, name))


@pytest.mark.parametrize("words", [*with_out(typer.main.get_command(app))], ids=" ".join)
def test_no_text_is_no_place_for_output(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(typer.BadParameter) as refused:
        app([*words, "--out", ""], standalone_mode=False)
    assert refused.value.format_message() == "Invalid value for '--out': got '', expected a path"
    assert not list(tmp_path.iterdir())


EXTENDED = """name = "x"
[robot]
wheel_radius = 0.0205
axle = 0.053
body_radius = 0.035
wheel_speed_max = 6.28
[extension]
log = "another"
[[extension.causes]]
name = "wheel_radius_scale"
parameters = { scale = { value = 1.02 } }
"""


@pytest.mark.parametrize(
    "words",
    [
        "gap wild.csv",
        "diagnose wild.csv",
        "reference wild.csv --jobs 1",
        "gain --log wild.csv --extended extended.toml --jobs 1",
        "gain --log mild.csv --healthy wild.csv --extended extended.toml --jobs 1",
        "import csv wild.csv --map map.toml",
    ],
)
def test_every_reader_of_logs_refuses_commands_that_no_wheel_can_follow(words, tmp_path):
    frame = driven_log(1, rows=300, robots=1, position_noise=1e-3)
    frame.to_csv(tmp_path / "mild.csv", index=False)
    lengths = {name: 1000.0 * frame[name] for name in ("x", "y", "cmd_left", "cmd_right")}
    frame.assign(**lengths).to_csv(tmp_path / "wild.csv", index=False)
    (tmp_path / "extended.toml").write_text(EXTENDED)
    units = {"t": "s", "x": "m", "y": "m", "yaw": "rad", "cmd_left": "rad/s", "cmd_right": "rad/s"}
    lines = [f'{name} = {{ from = "{name}", unit = "{unit}" }}' for name, unit in units.items()]
    (tmp_path / "map.toml").write_text("\n".join(["[columns]", *lines]))
    done = realitygap(*words.split(), "--out", "out.parquet", cwd=tmp_path)
    assert done.returncode == 2
    assert "commands: got wheel speeds of" in done.stderr.splitlines()[-1]
    assert "at most 6.28 rad/s on this robot" in done.stderr

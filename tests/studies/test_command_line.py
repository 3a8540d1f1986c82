"""A command line for scripts: the same words, exit codes and JSON on every command."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any, get_args

import pandas as pd
import pytest
import typer
from typer.testing import CliRunner

import realitygap as rg
from realitygap.models.naming.diagnosis import Verdict
from realitygap.studies.cli import app
from realitygap.studies.cli.diagnose import CODES
from realitygap.studies.cli.outcome import Outcome, command
from realitygap.studies.cli.study import studied
from tests.helpers import ROOT, realitygap

WIDTH = 80
EXAMPLE = ROOT / "docs" / "example"
LOG = (EXAMPLE / "log.csv", "--map", EXAMPLE / "map.toml", "--model", EXAMPLE / "robot.toml")


def commands(group: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """The words of every command, groups left out."""
    for name, one in group.commands.items():
        if hasattr(one, "commands"):
            yield from commands(one, (*path, name))
        else:
            yield (*path, name)


EVERY = sorted(commands(typer.main.get_command(app)))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scripts") / "log.parquet"
    done = realitygap("import", "csv", *LOG, "--out", path)
    assert done.returncode == 0, done.stderr
    return path


@pytest.mark.parametrize("words", [(), ("study",), ("measure",), ("model",), *EVERY], ids=" ".join)
def test_help_has_a_short_form_and_fits_a_terminal(words: tuple[str, ...]) -> None:
    narrow = {"COLUMNS": str(WIDTH), "TERMINAL_WIDTH": str(WIDTH)}
    short, long = (CliRunner().invoke(app, [*words, word], env=narrow) for word in ("-h", "--help"))
    assert (short.exit_code, short.output) == (0, long.output)
    assert max(map(len, long.output.splitlines())) <= WIDTH
    assert "…" not in long.output  # nothing is cut
    if words in EVERY:
        assert "--json" in long.output
        assert "--log-level" in long.output


def test_the_list_of_commands_is_the_whole_command_line() -> None:
    assert {("diagnose",), ("model", "new"), ("study", "paper"), ("measure", "gain")} <= {*EVERY}


def test_a_paragraph_of_help_is_wrapped_as_a_whole() -> None:
    wide = realitygap("study", "transfer", "-h").stdout
    assert "Stopped or killed, the same command goes on with the runs that are missing." in wide


def test_the_version_is_printed() -> None:
    done = realitygap("--version")
    assert (done.returncode, done.stdout) == (0, f"realitygap {version('reality-gap')}\n")


def test_a_shell_completes_commands_and_options() -> None:
    def completed(words: str) -> str:
        place = str(len(words.split()) - 1)
        return subprocess.run(
            [Path(sys.executable).parent / "realitygap"],
            env={"_REALITYGAP_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": place},
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        ).stdout

    assert completed("realitygap dia").split() == ["diagnose"]
    assert "--exit-code" in completed("realitygap diagnose --ex")


@pytest.mark.parametrize(
    ("words", "file"),
    [
        pytest.param(
            ("gap", "LOG", "--model", EXAMPLE / "robot.toml", "--out", "OUT"),
            "gap.json",
            marks=pytest.mark.slow,
        ),
        (("diagnose", "LOG", "--model", EXAMPLE / "robot.toml", "--out", "OUT"), "diagnosis.json"),
        (("run", "--minutes", "0.05", "--robots", "2", "--out", "OUT"), "run.json"),
    ],
    ids=["gap", "diagnose", "run"],
)
def test_json_is_the_file_that_is_written_and_else_the_last_line_is_the_result(
    words: tuple[object, ...], file: str, log: Path, tmp_path: Path
) -> None:
    def asked(out: Path, *more: str) -> subprocess.CompletedProcess[str]:
        given = [{"LOG": log, "OUT": out}.get(str(word), word) for word in words]
        return realitygap(*given, *more)

    scripted = asked(tmp_path / "scripted", "--json")
    assert scripted.returncode == 0, scripted.stderr
    assert scripted.stdout == (tmp_path / "scripted" / file).read_text(encoding="utf-8")
    read = asked(tmp_path / "read")
    last = read.stdout.splitlines()[-1]
    assert ". See " in last
    assert Path(last.rpartition(". See ")[2]).exists()
    assert asked(tmp_path / "quiet", "--quiet").stdout == ""


@pytest.mark.parametrize(
    "words",
    [("effects",), ("rules",), ("model", "new", "--wheel-radius", "0.03", "--axle", "0.2")],
    ids=["effects", "rules", "model"],
)
def test_what_is_printed_is_printed_as_json_too(words: tuple[str, ...]) -> None:
    done = realitygap(*words, "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said
    plain = realitygap(*words)
    assert plain.stdout
    with pytest.raises(json.JSONDecodeError):
        json.loads(plain.stdout)


def test_an_import_says_what_it_read(tmp_path: Path) -> None:
    done = realitygap("import", "csv", *LOG, "--out", tmp_path / "log.parquet", "--json")
    said = json.loads(done.stdout)
    assert said["log"] == str(tmp_path / "log.parquet")
    assert said["rows"] == len(pd.read_parquet(tmp_path / "log.parquet"))


def test_a_study_is_its_tables(tmp_path: Path) -> None:
    table = pd.DataFrame({"claim": ["a", "b"], "p": [0.5, None]})
    table.to_csv(tmp_path / "claims.csv", index=False)
    table.to_parquet(tmp_path / "generations.parquet")
    ended = studied(rg.StudyResult(tmp_path, "two claims"))
    rows = [{"claim": "a", "p": 0.5}, {"claim": "b", "p": None}]
    assert ended.result["tables"] == {"claims": rows}
    assert ended.page == tmp_path / "report.html"


@pytest.fixture
def talkative() -> typer.Typer:
    """A program of one command whose work prints."""
    own = typer.Typer()

    @command(own, epilog="Example: none")
    def work(quiet: bool = False) -> Outcome:
        """Work."""
        typer.echo("noise")
        table = pd.DataFrame({"x": [1.0, float("inf")]})
        return Outcome(table, "two rows", Path("there.csv"), ["a note"], code=7)

    return own


def test_json_is_alone_on_standard_output_whatever_the_work_prints(talkative: typer.Typer) -> None:
    done = CliRunner().invoke(talkative, ["--json"])
    assert json.loads(done.stdout) == [{"x": 1.0}, {"x": None}]
    assert done.stderr == "noise\n"
    assert done.exit_code == 7


def test_notes_come_first_and_the_result_last(talkative: typer.Typer) -> None:
    done = CliRunner().invoke(talkative, [])
    assert done.stdout == "noise\na note\ntwo rows. See there.csv\n"
    assert CliRunner().invoke(talkative, ["--quiet"]).stdout == "noise\n"


def test_bad_input_leaves_json_empty(tmp_path: Path) -> None:
    done = realitygap("gap", tmp_path / "nowhere.csv", "--out", tmp_path / "gap", "--json")
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1


def test_every_verdict_has_an_exit_code_of_its_own() -> None:
    assert CODES.keys() == {*get_args(Verdict)}
    assert CODES["nothing_wrong"] == 0
    assert len({*CODES.values()}) == len(CODES)
    assert not {1, 2} & {*CODES.values()}


def test_a_diagnosis_ends_with_its_verdict_where_that_is_asked(log: Path, tmp_path: Path) -> None:
    words = ("diagnose", log, "--model", EXAMPLE / "robot.toml", "--quiet")
    asked = realitygap(*words, "--out", tmp_path / "asked", "--exit-code")
    verdict = json.loads((tmp_path / "asked" / "diagnosis.json").read_text())["verdict"]
    assert verdict != "nothing_wrong"
    assert asked.returncode == CODES[verdict]
    assert realitygap(*words, "--out", tmp_path / "plain").returncode == 0


def test_what_is_logged_can_be_chosen(log: Path, tmp_path: Path) -> None:
    words = ("gap", log, "--model", EXAMPLE / "robot.toml", "--quiet")
    plain = realitygap(*words, "--out", tmp_path / "plain")
    assert plain.stderr == ""
    told = realitygap(*words, "--out", tmp_path / "told", "--log-level", "info")
    assert "INFO realitygap: gap: reading the log\n" in told.stderr
    refused = realitygap("gap", "nowhere.csv", "--out", tmp_path / "x", "--log-level", "debug")
    assert "Traceback" in refused.stderr
    wrong = realitygap(*words, "--out", tmp_path / "x", "--log-level", "loud")
    assert wrong.returncode == 2
    assert "--log-level: got 'loud', expected one of debug, info" in wrong.stderr

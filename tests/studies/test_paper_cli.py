"""`realitygap study` says in one line what it cannot do."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from realitygap.studies.cli import main
from realitygap.studies.paper.execution import RunsFailed


def _run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["realitygap", "study", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


@pytest.mark.parametrize(
    ("words", "field"),
    [
        (("paper", "--runs", "0"), "--runs"),
        (("paper", "--minutes", "nan"), "--minutes"),
        (("readings", "--robots", "0"), "--robots"),
        (("paper", "--seed", "-1"), "--seed"),
        (("paper", "--model", "epuk"), "did you mean epuck"),
        (("paper", "--jobs", "0"), "--jobs"),
        (("paper", "--scheduler", "nowhere"), "--scheduler"),
        (("paper", "--jobs", "2", "--scheduler", "tcp://127.0.0.1:1"), "--jobs"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    words: tuple[str, ...],
    field: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "study"
    assert _run(monkeypatch, *words, "--out", str(out)) == 2
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert field in said
    assert not out.exists()


def test_an_output_that_is_a_file_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").touch()
    assert _run(monkeypatch, "paper", "--out", str(tmp_path / "taken")) == 2
    assert "--out" in capsys.readouterr().err


def test_runs_that_fail_end_in_one_line_and_exit_code_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*args: object, **options: object) -> None:
        raise RunsFailed("2 runs failed, first at-nest-00: InputError: too many robots")

    monkeypatch.setattr("realitygap.studies.paper.study.run_study", fail)
    assert _run(monkeypatch, "paper", "--out", str(tmp_path / "study")) == 1
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert "2 runs failed" in said


@pytest.mark.parametrize(
    ("name", "run"),
    [
        ("paper", "realitygap.studies.paper.study.run_study"),
        ("readings", "realitygap.studies.paper.study.run_study"),
        ("transfer", "realitygap.studies.transfer.study.run_transfer"),
    ],
)
def test_a_study_ends_with_its_result_and_the_path_of_its_page(
    name: str,
    run: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(run, lambda *args, **options: "What came out.")
    page = tmp_path / "study" / "report.html"
    assert _run(monkeypatch, name, "--out", str(page.parent)) == 0
    assert capsys.readouterr().out.splitlines() == [f"What came out. See {page}"]
    assert _run(monkeypatch, name, "--out", str(page.parent), "--quiet") == 0
    assert capsys.readouterr().out == ""


def test_help_shows_an_example(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("paper", "readings"):
        assert _run(monkeypatch, name, "--help") == 0
        assert "Example" in capsys.readouterr().out

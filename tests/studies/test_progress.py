import pytest

from realitygap.studies.paper.conditions import PAPER, plan
from realitygap.studies.paper.execution import Tally
from realitygap.studies.plumbing.progress import Progress, Stages
from tests.studies.small_study import TINY


def watch(*, quiet: bool) -> None:
    """Half of a command and its last word; the last run of a study that lacked one."""
    with Progress("run", 10.0, quiet) as shown:
        shown.reach(0.0)
        shown.reach(5.0)
    shown.say("written")
    runs = plan(TINY, PAPER)
    with Tally(runs, runs[-1:], quiet=quiet) as tally:
        tally.finished(runs[-1])


def test_without_a_terminal_progress_is_a_line_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    watch(quiet=False)
    seldom = capsys.readouterr().err.splitlines()
    monkeypatch.setattr("realitygap.studies.plumbing.progress.LINE_SECONDS", 0.0)
    watch(quiet=False)
    said = capsys.readouterr()
    assert said.out == ""
    always = said.err.splitlines()
    assert always.pop(0).startswith("run: 50 %, about 0 s left")
    for lines in (seldom, always):
        assert lines[:2] == ["written", "7 of 8 runs are there already"]
        assert lines[2].startswith("8 of 8 runs, ")
        assert len(lines) == 3


def test_quiet_progress_says_nothing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("realitygap.studies.plumbing.progress.LINE_SECONDS", 0.0)
    watch(quiet=True)
    said = capsys.readouterr()
    assert said.out + said.err == ""


def test_on_a_terminal_progress_is_a_bar_with_the_time_left(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    watch(quiet=False)
    said = capsys.readouterr().err
    assert "50%" in said
    assert "8/8" in said
    watch(quiet=True)
    assert capsys.readouterr().err == ""


def test_stages_are_named_on_a_terminal_alone(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def read(*, quiet: bool) -> str:
        with Stages("gap", quiet) as shown:
            shown.begin("reading the log")
        return capsys.readouterr().err

    assert read(quiet=False) == ""
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "gap: reading the log" in read(quiet=False)
    assert read(quiet=True) == ""

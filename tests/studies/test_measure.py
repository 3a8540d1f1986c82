"""What the documents say of the program is measured again by its own command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from realitygap.embedded_sim import InputError
from realitygap.studies.cli import app
from realitygap.studies.measure import ambiguous, bench, gain_table, inherent_gap
from tests.helpers import ROOT, realitygap


def refused(*words: object) -> str:
    done = CliRunner().invoke(app, list(map(str, words)))
    assert isinstance(done.exception, InputError)
    return str(done.exception)


def test_no_document_names_another_command_line() -> None:
    texts = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "Makefile"]
    for path in [*texts, *sorted((ROOT / "docs").rglob("*.md"))]:
        assert "python -m realitygap" not in path.read_text(encoding="utf-8"), path
    rooms = [path for path in (ROOT / "studies").rglob("*.py") if path.name != "command.py"]
    assert [path for path in rooms if '"__main__"' in path.read_text(encoding="utf-8")] == []


def test_every_measurement_that_a_document_names_is_there() -> None:
    texts = [ROOT / "Makefile", *sorted((ROOT / "docs").rglob("*.md"))]
    named = {
        name
        for path in texts
        for name in re.findall(r"realitygap measure ([a-z-]+)", path.read_text(encoding="utf-8"))
    }
    assert named == {
        *("ambiguous", "bench", "convergence", "gain", "healthy-scores"),
        *("inherent-gap", "real", "scaling"),
    }
    for name in named:
        assert CliRunner().invoke(app, ["measure", name, "--help"]).exit_code == 0


def test_bad_words_are_refused_before_anything_is_measured(tmp_path: Path) -> None:
    out = tmp_path / "out"
    for name in ("bench", "scaling", "inherent-gap", "gain"):
        assert "--minutes: got nan" in refused("measure", name, "--minutes", "nan", "--out", out)
    assert "--times: got inf" in refused("measure", "gain", "--times", "inf", "--out", out)
    assert "did you mean motor_lag" in refused(
        "measure", "gain", "--only", "motor_la", "--out", out
    )
    assert "did you mean wall or sensors" in refused(
        "measure", "ambiguous", "--only", "wall or sensor", "--out", out
    )
    assert not out.exists()


def test_what_is_there_is_kept_unless_forced(tmp_path: Path) -> None:
    (tmp_path / "there.json").write_text("{}")
    for name in ("bench", "ambiguous"):
        assert "does not exist yet" in refused("measure", name, "--out", tmp_path / "there.json")
    assert (tmp_path / "there.json").read_text() == "{}"


def test_the_bench_writes_figures_and_shares(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "point_model", lambda: {"embedded_best_ns": 15.0})
    monkeypatch.setattr(bench, "command", lambda *words: 0.3)
    words = ["measure", "bench", "--minutes", "0.02", "--out", str(tmp_path / "bench.json")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    found = json.loads((tmp_path / "bench.json").read_text())
    assert found["run_over_bare"] > 0.5
    assert set(found["shares"]) >= {"physics", "infrared", "recording"}
    assert "co_evolution_times_real_time: " in done.output
    assert "physics: " in done.output


def test_the_inherent_gap_is_a_mean_over_seeds_with_its_error(tmp_path: Path) -> None:
    out = tmp_path / "gap"
    inherent_gap.inherent_gap(out, seeds=2, minutes=0.5)
    found = json.loads((out / "inherent-gap.json").read_text())
    seeds = pd.read_csv(out / "seeds.csv")
    assert len(seeds) == 2
    mean, error = found["noise_mm"]
    assert mean == pytest.approx(seeds["noise_mm"].mean())
    assert error == pytest.approx(seeds["noise_mm"].sem())


def test_trials_of_a_pair_are_a_table(tmp_path: Path) -> None:
    lines: list[str] = []
    table = ambiguous.ambiguous(
        tmp_path / "a.csv", trials=1, only=["droop or radius"], jobs=1, say=lines.append
    )
    assert [json.loads(line)["pair"] for line in lines] == ["droop or radius"]
    assert list(pd.read_csv(tmp_path / "a.csv")["truth"]) == list(table["truth"])


def test_healthy_scores_are_drawn_and_told(tmp_path: Path) -> None:
    run = tmp_path / "run"
    words = ("run", "--controller", "search", "--minutes", "0.5", "--robots", "3", "--seed", "4")
    assert realitygap(*words, "--out", run).returncode == 0
    done = realitygap("measure", "healthy-scores", run, "--out", tmp_path / "scores.png")
    assert done.returncode == 0, done.stderr
    assert re.search(r"beyond 2: 0\.\d{5} of \d+; normal 0\.04550", done.stdout)
    assert (tmp_path / "scores.png").read_bytes().startswith(b"\x89PNG")


def test_gains_are_told_as_a_table_with_totals() -> None:
    row = {"effect": "motor_lag", "hidden": "0.05 s", "answer": "named", "channel": "heading"}
    row |= {"unit": "rad", "before": 0.02, "healthy": 0.01, "extended": 0.011, "oracle": 0.01}
    for name, value in (("over_healthy", 1.1), ("closed", 0.9)):
        row |= {name: value, f"{name}_low": value - 0.1, f"{name}_high": value + 0.1}
    text = gain_table.markdown(pd.DataFrame([row]))
    assert "| motor_lag | 0.05 s | named | heading (mrad) | 20 | 10 | 11 | 10 |" in text
    assert "1 of 1 named; in 1 of them there was something to gain" in text

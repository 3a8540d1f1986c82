"""What the study's documentation shows works as shown."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import pytest

from studies.paper.claims import CLAIMS
from studies.paper.conditions import PAPER

DOCS = Path(__file__).parents[2] / "docs"


def test_five_lines_of_pandas_rebuild_figure_6(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = [
        {"label": condition.label, "food_total": 10 + run, "food_first": 4 + run}
        for condition in PAPER
        for run in range(3)
    ]
    (tmp_path / "out" / "study").mkdir(parents=True)
    pd.DataFrame(rows).to_parquet(tmp_path / "out" / "study" / "study.parquet")
    monkeypatch.chdir(tmp_path)
    block = re.search(r"```python\n(.*?)```", (DOCS / "study.md").read_text(), re.DOTALL)
    assert block is not None
    assert len([line for line in block[1].splitlines() if line]) == 5
    shown: dict[str, object] = {}
    with mpl.rc_context({"backend": "agg"}):
        exec(block[1], shown)
        axes = shown["axes"]
        bars = [bar.get_height() for bar in axes.patches]  # type: ignore[attr-defined]
        mpl.pyplot.close("all")
    assert bars[:8] == [11.0] * 8
    assert bars[8:16] == [5.0] * 8


def test_the_committed_claims_are_those_of_the_code_and_none_that_failed_is_passed_over() -> None:
    claims = pd.read_csv(DOCS / "paper-study" / "claims.csv")
    assert claims["claim"].tolist() == [claim.key for claim in CLAIMS]
    assert claims["text"].tolist() == [claim.text for claim in CLAIMS]
    told = (DOCS / "paper-study" / "README.md").read_text(encoding="utf-8")
    for key in claims.loc[claims["verdict"] == "not reproduced", "claim"]:
        assert f"`{key}`" in told


def test_the_committed_study_has_eighty_runs_of_an_hour() -> None:
    runs = pd.read_parquet(DOCS / "paper-study" / "study.parquet")
    assert len(runs) == 8 * 10
    assert (runs["minutes"] == 60.0).all()

"""What the study's documentation shows works as shown."""

from __future__ import annotations

import json
import re
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import pytest

from realitygap.studies.pages.page import markdown
from realitygap.studies.paper.claims import CLAIMS
from realitygap.studies.paper.conditions import PAPER, STUDIED, StudyConfig
from realitygap.studies.paper.mixture import mixture_table
from realitygap.studies.paper.notes import LAMP, MUTATION, NOTES, POOLED
from realitygap.studies.paper.results import result_sections
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.verdicts import weigh_claims

DOCS = Path(__file__).parents[2] / "docs"
STUDY = DOCS / "paper-study"


def test_five_lines_of_pandas_rebuild_figure_6(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = [
        {"label": condition.label, "food_total": 10 + run, "food_first": 4 + run}
        for condition in STUDIED
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
    assert bars[:10] == [11.0] * 10
    assert bars[10:20] == [5.0] * 10


def test_the_committed_claims_are_those_of_the_code_and_none_that_failed_is_passed_over() -> None:
    claims = pd.read_csv(STUDY / "claims.csv")
    assert claims["claim"].tolist() == [claim.key for claim in CLAIMS]
    assert claims["text"].tolist() == [claim.text for claim in CLAIMS]
    told = (STUDY / "README.md").read_text(encoding="utf-8")
    for key in claims.loc[claims["verdict"] == "not reproduced", "claim"]:
        assert f"`{key}`" in told


def test_the_committed_study_has_ten_runs_of_an_hour_in_every_condition_of_the_paper() -> None:
    runs = pd.read_parquet(STUDY / "study.parquet")
    number = runs.groupby("condition").size()
    assert set(number[[condition.name for condition in PAPER]]) == {10}
    assert set(runs["condition"]) <= {condition.name for condition in STUDIED}
    assert (runs["minutes"] == 60.0).all()
    noted = json.loads((STUDY / "study.json").read_text(encoding="utf-8"))["seeds"]
    names = runs["condition"] + "-" + runs["run"].map("{:02d}".format)
    assert dict(zip(names, runs["seed"], strict=True)) == noted


def test_the_committed_results_are_what_the_code_makes_of_the_committed_tables() -> None:
    noted = json.loads((STUDY / "study.json").read_text(encoding="utf-8"))["configuration"]
    told = (STUDY / "README.md").read_text(encoding="utf-8")
    assert told.endswith("-->\n\n" + markdown(result_sections(StudyConfig(**noted), STUDY)))


def test_the_committed_mixture_is_that_of_the_committed_runs() -> None:
    runs = pd.read_parquet(STUDY / "study.parquet")
    found = mixture_table(StudyTables(runs, pd.DataFrame(), 60.0), 0)
    pd.testing.assert_frame_equal(found, pd.read_csv(STUDY / "mixture.csv"), rtol=1e-5)


@pytest.mark.slow
def test_the_committed_claims_are_those_of_the_committed_runs() -> None:
    runs = pd.read_parquet(STUDY / "study.parquet")
    none = pd.DataFrame(columns=["condition", "index", "minute", "s0_third"], dtype=float)
    found = weigh_claims(StudyTables(runs, none, 60.0), 0).set_index("claim")
    kept = pd.read_csv(STUDY / "claims.csv", keep_default_na=True).set_index("claim")
    timed = [key for key in found.index if key.startswith("persists-")]  # of generations, not runs
    columns = ["effect", "low", "high", "p", "p_against", "verdict", "points"]
    pd.testing.assert_frame_equal(
        found.drop(index=timed)[columns], kept.drop(index=timed)[columns], rtol=1e-5
    )


def test_what_depends_on_our_choices_says_so_beside_the_claim() -> None:
    claims = pd.read_csv(STUDY / "claims.csv").set_index("claim")
    notes = claims["notes"].fillna("")
    depends = pd.read_csv(STUDY / "dependence.csv").set_index("claim")
    for note, on in ((LAMP, "on the lamp"), (MUTATION, "on the reading")):
        concerned = set(depends.index[depends[on] == "depends"])
        assert concerned <= set(note.claims)
        assert all(note.label in notes[key] for key in note.claims)
    assert set(notes.index[notes.str.contains(POOLED.label)]) == set(POOLED.claims)
    bounds = claims["claimed_above"].eq(1.0) & claims["claimed_below"].eq(float("inf"))
    bounds |= claims["claimed_below"].isin([0.0, 1.0])
    assert set(notes.index[notes.str.contains("any difference counts")]) == set(notes[bounds].index)


def test_every_note_is_of_claims_that_exist() -> None:
    keys = {claim.key for claim in CLAIMS}
    assert all(set(note.claims) <= keys for note in NOTES)

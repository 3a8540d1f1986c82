"""What the study's documentation shows works as shown."""

from __future__ import annotations

import json
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

from realitygap.studies.pages.page import markdown
from realitygap.studies.paper.claims import CLAIMS
from realitygap.studies.paper.conditions import STUDIED, StudyConfig
from realitygap.studies.paper.readings import of_variant
from realitygap.studies.paper.results import result_sections
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.paper.verdicts import ALIKE, FAILS, NOTES, OPEN, decide

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
    assert bars[:11] == [11.0] * 11
    assert bars[11:22] == [5.0] * 11


def test_the_committed_claims_are_those_of_the_code_and_none_that_fails_is_passed_over() -> None:
    claims = pd.read_csv(STUDY / "claims.csv")
    assert claims["claim"].tolist()[: len(CLAIMS)] == [claim.key for claim in CLAIMS]
    assert claims["text"].tolist()[: len(CLAIMS)] == [claim.text for claim in CLAIMS]
    told = (STUDY / "README.md").read_text(encoding="utf-8")
    for key in claims.loc[claims["verdict"].isin([FAILS, ALIKE]), "claim"]:
        assert f"`{key}`" in told


def test_the_committed_runs_are_of_an_hour_and_have_the_seeds_that_they_were_given() -> None:
    runs = pd.read_parquet(STUDY / "study.parquet")
    assert (runs["minutes"] == 60.0).all()
    noted = json.loads((STUDY / "study.json").read_text(encoding="utf-8"))["seeds"]
    names = runs["condition"] + "-" + runs["run"].map("{:02d}".format)
    names = names.where(runs["variant"] == "default", runs["variant"] + "." + names)
    assert len(runs) >= 10
    assert dict(zip(names, runs["seed"], strict=True)) == noted


def test_the_committed_results_are_what_the_code_makes_of_the_committed_tables() -> None:
    noted = json.loads((STUDY / "study.json").read_text(encoding="utf-8"))["configuration"]
    told = (STUDY / "README.md").read_text(encoding="utf-8")
    assert told.endswith("-->\n\n" + markdown(result_sections(StudyConfig(**noted), STUDY)))


def test_the_committed_claims_are_those_of_the_committed_runs() -> None:
    runs, generations = (
        pd.read_parquet(STUDY / f"{name}.parquet") for name in ("study", "generations")
    )
    noted = json.loads((STUDY / "study.json").read_text(encoding="utf-8"))["configuration"]
    everything = StudyTables(runs, generations, noted["minutes"])
    found = decide(of_variant(everything, "default"), noted["runs"])
    kept = pd.read_csv(STUDY / "claims.csv").head(len(found))
    columns = ["claim", "effect", "low", "high", "runs", "bound", "verdict"]
    pd.testing.assert_frame_equal(found[columns], kept[columns], rtol=1e-4, check_dtype=False)


def test_every_note_is_of_claims_that_exist() -> None:
    keys = {claim.key for claim in CLAIMS}
    assert all(set(note.claims) <= keys for note in NOTES)


def test_the_earlier_set_is_told_as_today_s_rule_has_it() -> None:
    runs = pd.read_parquet(STUDY / "pybullet.parquet")
    runs = runs.assign(near_positive=np.nan, near_negative=np.nan)  # it kept no positions
    none = pd.DataFrame(columns=["condition", "variant", "index", "minute", "s0_third"])
    found = decide(StudyTables(runs, none, 60.0), 10)
    told = (STUDY / "README.md").read_text(encoding="utf-8")
    decided = found[found["verdict"] != OPEN]
    assert len(decided) > 5
    for row in decided.to_dict("records"):
        (line,) = [line for line in told.splitlines() if line.startswith(f"| `{row['claim']}`:")]
        assert line.endswith(f"): {row['verdict']} |")

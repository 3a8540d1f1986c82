"""The study of readings: what it varies, and what it concludes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim.genome import reading
from realitygap.studies.paper.claims import PAPERS
from realitygap.studies.paper.conditions import PAPER, StudyConfig, plan
from realitygap.studies.paper.figures import lamps
from realitygap.studies.paper.readings import (
    LAMPS,
    READINGS,
    VARIANTS,
    depends,
    reading_conditions,
)
from realitygap.studies.paper.study import run_study
from realitygap.studies.plumbing.execution import Workers


def test_every_standard_deviation_meets_every_rule_and_every_lamp_is_there() -> None:
    assert len(READINGS) == 3 * 3 + 2
    assert len(LAMPS) == 3
    changed = {
        (found.environment_sd, found.bounding)
        for changes in READINGS.values()
        if "reading" not in changes
        for found in [reading("default", **changes)]  # type: ignore[arg-type]
    }
    assert changed == {(s, b) for s in (2.0, 0.2, 0.02) for b in ("clamp", "wrap", "reflect")}


def test_runs_of_different_variants_have_different_names_and_seeds() -> None:
    runs = plan(StudyConfig(study="readings", runs=2), reading_conditions())
    assert len({run.name for run in runs}) == len(runs)
    assert len({run.config.seed for run in runs}) == len(runs)


def test_the_default_variant_repeats_the_runs_of_the_paper_study() -> None:
    paper = plan(StudyConfig(runs=1), PAPER)
    readings = plan(StudyConfig(study="readings", runs=1), reading_conditions())
    assert [run.config for run in readings[: len(paper)]] == [run.config for run in paper]


def test_a_claim_that_holds_without_selection_proves_nothing() -> None:
    rows = [
        {"claim": claim.key, "variant": variant, "verdict": "holds"}
        for claim in PAPERS
        for variant in VARIANTS
    ]
    table = pd.DataFrame(rows)
    first, second = PAPERS[0].key, PAPERS[1].key
    table.loc[(table["claim"] == first) & (table["variant"] == "neutral"), "verdict"] = (
        "does not hold"
    )
    table.loc[(table["claim"] == second) & (table["variant"] == "lamp2"), "verdict"] = (
        "does not hold"
    )
    found = depends(table).set_index("claim")
    assert found.loc[first, "says"] == "needs selection"
    assert found.loc[second, "says"] == "proves nothing"
    assert found.loc[second, "on the lamp"] == "depends"
    assert found.loc[second, "on the reading"] == "does not"


@pytest.mark.slow
def test_a_study_of_readings_leaves_its_tables_figures_and_page(tmp_path: Path) -> None:
    out = tmp_path / "readings"
    config = StudyConfig(study="readings", runs=3, minutes=0.2, robots=2)
    run_study(config, out, Workers(2), quiet=True)
    names = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    expected = {"readings.csv", "dependence.csv", "study.parquet", "report.html"}
    expected |= {f"figures/readings-{n}.{k}" for n in ("claims", "food") for k in ("png", "svg")}
    assert expected <= names
    weighed = pd.read_csv(out / "readings.csv")
    assert len(weighed) == len(PAPERS) * len(VARIANTS)
    assert np.isfinite(weighed["effect"]).any()


def test_the_claims_of_figure_6_are_drawn_against_the_lamp_s_range() -> None:
    drawn = [claim.key for claim in PAPERS if claim.family == "Fig. 6"]
    rows = [
        {"claim": key, "variant": variant, "effect": 2.0, "low": 1.5, "high": 3.0}
        for key in drawn
        for variant in ("default", *LAMPS, "neutral")
    ]
    claims = pd.DataFrame({"claim": drawn, "family": "Fig. 6"})
    figure = lamps(pd.DataFrame(rows), claims.assign(claimed_above=1.0, claimed_below=np.inf))
    titled = {axes.get_title(): axes for axes in figure.axes}
    assert list(titled) == drawn
    points = titled["two-best"].lines[0].get_xdata()
    assert sorted(points) == [0.6, 0.8, 1.0, 2.0]

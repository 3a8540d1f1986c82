"""Runs are added where claims are open, nowhere else, and a stopped study goes the same way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.studies.paper import rounds
from realitygap.studies.paper.claims import CLAIMS
from realitygap.studies.paper.conditions import PAPER, SIZED, STUDIED, StudyConfig, plan
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.our_claims import NUMBER, SELECTION
from realitygap.studies.paper.rounds import Directory, Rounds, grown, studied_in
from realitygap.studies.paper.study import run_study
from realitygap.studies.paper.tables import Known, StudyTables
from realitygap.studies.plumbing.execution import Workers

STUDY = StudyConfig(runs=10, until_decided=True)
BY_KEY = {claim.key: claim for claim in CLAIMS}
AT_HAND = {condition.name: condition for condition in STUDIED}
LEVELS = {"at-nest": 300.0, "no-light": 100.0, "fixed-search": 100.0, "fixed-positive": 300.0}
"""Mean items; the others have 200."""


def test_only_conditions_of_open_claims_get_runs_and_those_that_lag_first() -> None:
    runs = dict.fromkeys(AT_HAND, 10)
    found = grown(runs, AT_HAND, [BY_KEY["search-equivalent"]], 10)
    assert found == runs | {"no-light": 20, "fixed-search": 20}
    found = grown(found, AT_HAND, [BY_KEY["light-useful"]], 10)
    assert found == runs | {"no-light": 20, "fixed-search": 20, "at-nest": 20}
    full = dict.fromkeys(AT_HAND, 60)
    assert grown(full, AT_HAND, CLAIMS, 10) == full
    assert grown(runs, AT_HAND, [], 10) == runs


def test_a_variant_adds_runs_of_its_own_and_of_the_default_where_it_has_none() -> None:
    at_hand = AT_HAND | {one.name: one for one in studied_in("literal")}
    runs = dict.fromkeys((one.key for one in (*STUDIED, *studied_in("literal"))), 10)
    found = grown(runs, at_hand, [BY_KEY["search-equivalent"]], 10)
    assert found == runs | {"literal.no-light": 20, "fixed-search": 20}


def test_a_name_is_the_variant_s_own_condition_and_across_variants_a_key() -> None:
    directory = StudyDirectory(Path("unused"), STUDY, ())
    study = Rounds(directory, Workers(1), lambda directory: None, quiet=True)
    study.runs = dict.fromkeys(
        (one.key for name in ("default", "literal", "number") for one in studied_in(name)), 10
    )
    assert study.at_hand("literal")["no-light"].variant == "literal"
    assert study.at_hand("literal")["fixed-search"].variant == "default"
    for stage in ("number", "default"):
        assert study.at_hand(stage)["opposite-to-at-nest"].variant == "default"
    wanted = {name for claim in NUMBER for name in claim.conditions}
    assert wanted <= set(study.at_hand("number"))


def test_other_numbers_of_robots_are_as_dense_and_see_the_lamp_as_far_across() -> None:
    for run in plan(StudyConfig(runs=1), SIZED):
        config = run.config
        assert config.robots / config.arena_radius**2 == pytest.approx(10 / 0.6**2)
        assert config.lamp_range == pytest.approx(config.arena_radius * 0.8 / 0.6)


class Fake:
    """Runs whose food is drawn from their seeds."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, stop_after: int = 10_000) -> None:
        self.made: list[str] = []
        self.reports = 0
        self.stop_after = stop_after
        claims = tuple(BY_KEY[key] for key in ("search-equivalent", "light-useful"))
        monkeypatch.setattr(rounds, "execute", self.execute)
        monkeypatch.setattr(rounds, "collect", self.collect)
        monkeypatch.setattr(rounds, "DECIDED", ("default",))
        monkeypatch.setattr(rounds, "claims_of", lambda variant: claims)

    def execute(self, directory: Directory, *args: object, **options: object) -> None:
        for run in directory.pending():
            if len(self.made) == self.stop_after:
                raise KeyboardInterrupt
            directory.keep(run, {"a": b""})
            self.made.append(run.name)

    def collect(self, directory: Directory, known: Known) -> StudyTables:
        rows = [
            {
                "condition": run.condition.name,
                "variant": "default",
                "run": run.index,
                "food_total": np.random.default_rng(run.config.seed).normal(
                    LEVELS.get(run.condition.name, 200.0), 20.0
                ),
            }
            for run in directory.runs
        ]
        none = pd.DataFrame(columns=["condition", "variant", "index"])
        return StudyTables(pd.DataFrame(rows), none, 60.0)

    def go(self, out: Path) -> dict[str, int]:
        with StudyDirectory(out, STUDY, plan(STUDY, STUDIED)).held() as directory:
            study = Rounds(directory, Workers(1), self.report, quiet=True)
            study.finish()
            return study.runs

    def report(self, directory: Directory) -> None:
        self.reports += 1


def test_runs_are_added_until_the_open_claim_is_decided(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake = Fake(monkeypatch)
    runs = fake.go(tmp_path / "study")
    assert 10 < runs["no-light"] == runs["fixed-search"] < 60
    assert {name: n for name, n in runs.items() if n > 10}.keys() == {"no-light", "fixed-search"}
    assert len(fake.made) == sum(runs.values()) == len(set(fake.made))
    assert fake.reports == runs["no-light"] // 10
    assert set(fake.made[: 10 * len(STUDIED)]) == {run.name for run in plan(STUDY, STUDIED)}


def test_a_stopped_study_goes_the_same_way_and_does_no_run_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = Fake(monkeypatch)
    expected = whole.go(tmp_path / "whole")
    stopped = Fake(monkeypatch, stop_after=len(whole.made) - 3)
    with pytest.raises(KeyboardInterrupt):
        stopped.go(tmp_path / "stopped")
    again = Fake(monkeypatch)
    assert again.go(tmp_path / "stopped") == expected
    assert stopped.made + again.made == whole.made
    assert Fake(monkeypatch).go(tmp_path / "stopped") == expected


@pytest.mark.slow
def test_a_decided_study_leaves_its_claims_by_variant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("realitygap.studies.fitness_gap.generations.TRIALS", 20)
    monkeypatch.setattr("realitygap.studies.paper.sequential.MOST_RUNS", 3)
    monkeypatch.setattr(rounds, "DECIDED", ("default", "neutral", "selection", "number"))
    out = tmp_path / "study"
    config = StudyConfig(runs=3, minutes=0.3, robots=3, engine="mujoco", until_decided=True)
    said = run_study(config, out, Workers(2), quiet=True)
    assert said.startswith("Of 35 claims of the paper: ")
    weighed = pd.read_csv(out / "readings.csv")
    assert weighed.groupby("variant").size().to_dict() == {"default": len(CLAIMS), "neutral": 35}
    runs = pd.read_parquet(out / "study.parquet")
    assert len(runs) == 3 * (len(STUDIED) + len(PAPER[:5]) + len(SIZED))
    claims = pd.read_csv(out / "claims.csv")
    assert claims["claim"].tolist() == [one.key for one in (*CLAIMS, *SELECTION, *NUMBER)]
    assert np.isfinite(runs["touching"]).all()

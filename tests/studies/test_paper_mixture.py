"""Fixed controllers dealt to robots by turns; the mixture told whichever way it goes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from realitygap.embedded_sim.breeding import Fixed
from realitygap.studies.paper.conditions import MIXTURE, PAPER, STUDIED, StudyConfig, plan
from realitygap.studies.paper.mixture import evolved_table, mixture_table, mixture_text
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.run.experiment import RunConfig, simulate

RUNS = np.arange(10.0)


@pytest.fixture(autouse=True)
def _few_resamples(monkeypatch: pytest.MonkeyPatch) -> None:
    """The differences below are clear to any number of them."""
    monkeypatch.setattr("realitygap.studies.paper.statistics.RESAMPLES", 200)


def _tables(*, mixed: float, to_and_fro: float, evolved: float) -> StudyTables:
    food = {
        "at-nest": evolved + 3.0 * RUNS,
        "fixed-positive": 600.0 + 20.0 * RUNS,
        "fixed-to-and-fro": to_and_fro + 20.0 * RUNS,
        "fixed-mixture": mixed + 20.0 * RUNS,
    }
    runs = pd.DataFrame(
        [
            {"condition": name, "variant": "default", "run": run, "food_total": value}
            for name, values in food.items()
            for run, value in enumerate(values)
        ]
    )
    generations = pd.DataFrame(
        [
            ("at-nest", 0, 10.0, 0, 0, 9),
            *[("at-nest", 0, 40.0, 2, 1, 3)] * 3,
            ("at-nest", 1, 40.0, 2, 0, 5),
            ("no-light", 2, 40.0, 0, 0, 0),
        ],
        columns=["condition", "index", "minute", "g0_third", "g1_third", "deposits"],
    )
    return StudyTables(runs, generations, 60.0)


def _said(tables: StudyTables) -> str:
    return " ".join(mixture_text(mixture_table(tables, 0), evolved_table(tables)))


def test_genomes_are_dealt_to_the_robots_by_turns() -> None:
    both = Fixed((0.9, 0.5), (0.9, 0.1))
    assert [both.start(robot).genome[1] for robot in range(4)] == [0.5, 0.1, 0.5, 0.1]
    assert {Fixed((0.9, 0.5)).start(robot).genome for robot in range(4)} == {(0.9, 0.5)}


def test_every_second_robot_of_the_mixture_leaves_the_light_without_food(tmp_path: Path) -> None:
    simulate(RunConfig(controller="half-to-and-fro", minutes=0.1, robots=3), (), tmp_path)
    rows = pd.read_parquet(tmp_path / "generations.parquet").set_index("robot")
    assert rows["g0"].tolist() == [0.9] * 3
    assert rows.loc[[0, 1, 2], "g1"].tolist() == [0.5, 0.1, 0.5]


def test_the_mixture_and_either_alone_meet_the_same_seeds() -> None:
    seeds = {
        name: [
            run.config.seed
            for run in plan(StudyConfig(runs=3), STUDIED)
            if run.condition.name == name
        ]
        for name in ("fixed-positive", "fixed-to-and-fro", "fixed-mixture")
    }
    assert seeds["fixed-positive"] == seeds["fixed-to-and-fro"] == seeds["fixed-mixture"]
    assert len(set(seeds["fixed-positive"])) == 3
    assert STUDIED[: len(PAPER)] == PAPER  # no run of the paper's conditions has another seed
    assert {condition.case for condition in MIXTURE} == {"light-at-nest"}


def test_differences_of_fixed_controllers_are_those_of_pairs() -> None:
    table = mixture_table(_tables(mixed=650.0, to_and_fro=640.0, evolved=800.0), 0)
    found = table.set_index(["first", "second"])
    paired = found.loc[("fixed-mixture", "fixed-positive")]
    assert (paired["difference"], paired["low"], paired["high"]) == (50.0, 50.0, 50.0)
    assert paired["p"] == pytest.approx(2.0 / 1024.0)
    unpaired = found.loc[("at-nest", "fixed-mixture")]
    assert unpaired["low"] < unpaired["difference"] < unpaired["high"]


def test_only_runs_that_both_have_are_pairs() -> None:
    tables = _tables(mixed=650.0, to_and_fro=640.0, evolved=800.0)
    late = (tables.runs["condition"] == "fixed-mixture") & (tables.runs["run"] >= 6)
    fewer = replace(tables, runs=tables.runs[~late])
    found = mixture_table(fewer, 0).set_index(["first", "second"])
    assert found["runs"].tolist() == [10, 6, 6, 6, 10, 10]
    assert found.loc[("fixed-mixture", "fixed-positive"), "difference"] == 50.0


@pytest.mark.parametrize(
    ("mixed", "to_and_fro", "conclusion"),
    [
        (650.0, 640.0, "more than either alone: dividing the labour pays"),
        (650.0, 700.0, "less than the better of the two alone"),
        (650.0, 650.0, "does not clearly collect more than the better of the two alone"),
    ],
)
def test_the_text_says_what_came_out_whichever_way_it_went(
    mixed: float, to_and_fro: float, conclusion: str
) -> None:
    assert conclusion in _said(_tables(mixed=mixed, to_and_fro=to_and_fro, evolved=900.0))


def test_the_text_says_what_the_mixture_leaves_unexplained() -> None:
    for evolved, said in (
        (900.0, "lacks brings the rest"),
        (726.5, "no difference is shown"),
        (500.0, "find its controllers first"),
    ):
        assert said in _said(_tables(mixed=650.0, to_and_fro=640.0, evolved=evolved))


def test_two_pairs_decide_nothing_however_clear_they_look() -> None:
    tables = _tables(mixed=650.0, to_and_fro=640.0, evolved=900.0)
    said = _said(replace(tables, runs=tables.runs[tables.runs["run"] < 2]))
    assert "too few runs of the mixture" in said
    assert "So few runs decide nothing of the rest." in said
    none = tables.runs["condition"] != "fixed-mixture"
    assert "too few runs of the mixture" in _said(replace(tables, runs=tables.runs[none]))


def test_what_evolves_is_counted_in_the_second_half_with_light_at_the_nest() -> None:
    table = evolved_table(_tables(mixed=650.0, to_and_fro=640.0, evolved=800.0))
    found = table.set_index(["carrying_food", "without_food"])
    assert found.loc[("positive", "search"), "share"] == pytest.approx(0.75)
    assert found.loc[("positive", "negative"), "items"] == 5.0
    assert table["share"].sum() == pytest.approx(1.0)
    assert set(table["runs"]) == {2}

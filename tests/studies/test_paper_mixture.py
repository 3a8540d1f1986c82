"""Fixed controllers dealt to robots by turns; what evolves, of which they are made."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from realitygap.embedded_sim.breeding import Fixed
from realitygap.studies.paper.conditions import MIXTURE, PAPER, STUDIED, StudyConfig, plan
from realitygap.studies.paper.mixture import evolved_table, evolved_text
from realitygap.studies.paper.tables import StudyTables
from realitygap.studies.run.experiment import FIXED_SWARMS, RunConfig, simulate

EVOLVED = pd.DataFrame(
    [
        ("at-nest", 0, 10.0, 0, 0, 9),
        *[("at-nest", 0, 40.0, 2, 1, 3)] * 3,
        ("at-nest", 1, 40.0, 2, 0, 5),
        ("no-light", 2, 40.0, 0, 0, 0),
    ],
    columns=["condition", "index", "minute", "g0_third", "g1_third", "deposits"],
)


def test_genomes_are_dealt_to_the_robots_by_turns() -> None:
    both = Fixed((0.9, 0.5), (0.9, 0.1))
    assert [both.start(robot).genome[1] for robot in range(4)] == [0.5, 0.1, 0.5, 0.1]
    most = Fixed(*FIXED_SWARMS["most-to-and-fro"])
    assert sum(most.start(robot).genome[1] == 0.1 for robot in range(10)) == 7
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
        for name in ("fixed-positive", *(condition.name for condition in MIXTURE))
    }
    assert all(found == seeds["fixed-positive"] for found in seeds.values())
    assert len(set(seeds["fixed-positive"])) == 3
    assert STUDIED[: len(PAPER)] == PAPER  # no run of the paper's conditions has another seed
    assert {condition.case for condition in MIXTURE} == {"light-at-nest"}


def test_what_evolves_is_counted_in_the_second_half_with_light_at_the_nest() -> None:
    table = evolved_table(StudyTables(pd.DataFrame(), EVOLVED, 60.0))
    found = table.set_index(["carrying_food", "without_food"])
    assert found.loc[("positive", "search"), "share"] == pytest.approx(0.75)
    assert found.loc[("positive", "negative"), "items"] == 5.0
    assert table["share"].sum() == pytest.approx(1.0)
    assert set(table["runs"]) == {2}
    assert "75% of the controllers do the same, and 25% leave the lamp" in evolved_text(table)

"""Every effect becomes an unknown when its cause is taken out of the catalogue."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from realitygap.models.belief.catalogue import every_cause, without
from realitygap.models.naming.channels.motion.candidates import candidates
from realitygap.models.naming.channels.motion.flexible import QUANTITIES as OF_MOTION
from realitygap.models.naming.channels.senses.quantities import QUANTITIES as OF_READINGS
from realitygap.studies.blind.battery import run_battery
from realitygap.studies.blind.record import diagnose
from realitygap.studies.blind.summary import quantity_right
from realitygap.studies.blind.trials import ENTRIES, Hidden, Trial, blind_config, plan
from realitygap.studies.cli import app
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.run.experiment import RunConfig
from tests.blind.test_naming import told

STUB = partial(diagnose, command=(sys.executable, str(Path(__file__).with_name("stub.py"))))


def test_every_effect_is_left_out_by_turns_clearly_above_its_bar() -> None:
    effects = ("lamp_height", "ir_offset", "motor_lag")
    trials = plan(blind_config(trials=6, effects=effects, leave_one_out=True))
    assert [t.withheld for t in trials] == [(name,) for name in effects] * 2
    assert [t.hidden[0].name for t in trials] == [*effects, *effects]
    assert min(t.hidden[0].multiple for t in trials) >= 1.5


def follows(name: str) -> frozenset[str]:
    return frozenset(ENTRIES[name].follows.split())


def test_what_an_unknown_follows_is_said_of_every_effect_in_words_of_a_diagnosis() -> None:
    assert all(follows(name) for name in ENTRIES)
    assert set().union(*map(follows, ENTRIES)) <= {*OF_MOTION, *OF_READINGS}


def test_a_withheld_cause_is_not_tried_and_comes_back_afterwards() -> None:
    names = {term.cause.name for term in candidates()}
    assert "motor_lag" in names
    assert "command_latency" not in names  # its twin stands for it
    with without(("motor_lag", "clock_offset")):
        fewer = {term.cause.name for term in candidates()}
    assert fewer == names - {"motor_lag", "clock_offset"} | {"command_latency"}
    assert {term.cause.name for term in candidates()} == names


def test_the_quantity_counts_only_for_robots_that_have_the_effect() -> None:
    hidden = Hidden("lamp_decay", {}, (3,), 1.0, 1.0)
    trial = Trial(0, "left_out", 120.0, RunConfig(), (hidden,))
    said = {"unexplained": [{"quantity": "time", "robots": [4]}]}
    assert not quantity_right(follows("lamp_decay"), trial, said)
    said["unexplained"].append({"quantity": "time", "robots": "all"})
    assert quantity_right(follows("lamp_decay"), trial, said)
    assert not quantity_right(follows("ir_offset"), trial, said)
    assert not quantity_right(follows("ir_offset"), trial, None)


def test_a_battery_withholds_the_cause_and_scores_what_is_said_instead(tmp_path: Path) -> None:
    config = blind_config(
        trials=2,
        seed=2,
        effects=("ls_dead_sensor", "command_latency"),
        robots=3,
        seconds=(2.0,),
        leave_one_out=True,
    )
    summary = run_battery(config, tmp_path / "out", Workers(1), quiet=True, diagnosed=STUB)
    found = summary["leave_one_out"]
    assert summary["failed"] == []
    assert summary["wrong_names"]["trials"] == 0
    assert found["by_effect"]["ls_dead_sensor"]["flagged_unexplained"]["hits"] == 1
    assert found["by_effect"]["ls_dead_sensor"]["quantity_right"]["hits"] == 1
    assert found["by_effect"]["command_latency"]["flagged_unexplained"]["hits"] == 0
    assert found["wrong_name_alone"]["hits"] == 0


def test_an_unknown_name_to_do_without_is_refused(tmp_path: Path) -> None:
    given = ["diagnose", str(tmp_path), "--without", "lamp_hight", "--out", str(tmp_path / "o")]
    done = CliRunner().invoke(app, given)
    assert done.exit_code != 0
    assert "lamp_height" in str(done.exception) + done.output
    assert "lamp_height" in every_cause()


@pytest.mark.blind
def test_a_lamp_of_another_height_without_that_cause_is_called_unexplained() -> None:
    hidden = Hidden("lamp_height", {"height": 0.106}, (), 0.06, 3.0)
    trial, answer = told(hidden, seed=821, withheld=("lamp_height",))
    assert answer["verdict"] == "unexplained"
    assert quantity_right(follows("lamp_height"), trial, answer)

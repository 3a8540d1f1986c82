"""Which healthy reference a diagnosis goes by; a battery's go by the one asked for."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import realitygap as rg
from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.naming.health.reference import read_reference, shipped_file
from realitygap.studies.diagnosis.references import lasting_reference, references
from tests.golden.answers import log_file

ROBOT = read_model_file("epuck")


@pytest.mark.parametrize(
    ("recorder", "given", "world"),
    [
        ("reality pybullet", None, "pybullet"),
        ("reality mujoco", None, "mujoco"),
        ("reality pybullet-strict", None, "pybullet"),
        ("a lab", None, "pybullet"),
        ("", None, "pybullet"),
        ("reality mujoco", "pybullet", "pybullet"),
        ("reality pybullet", "mujoco", "mujoco"),
    ],
)
def test_health_is_that_of_the_world_asked_for_or_of_the_one_that_recorded_the_log(
    recorder: str, given: str | None, world: str
) -> None:
    log = replace(rg.read_log(log_file("healthy-search-no-light")).measured, recorder=recorder)
    path = shipped_file(ROBOT.name, world=world)
    assert path is not None
    motion, senses = references(given, log, ROBOT)
    assert motion == read_reference(path)
    assert senses is not None
    assert senses.command == motion.command
    assert references("none", log, ROBOT) == (None, None)


@pytest.mark.parametrize("conditions", [False, True])
def test_every_diagnosis_of_a_battery_goes_by_the_reference_asked_for(
    conditions: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Asked(Exception):
        pass

    def asked(directory: Any, workers: Any, quiet: Any, diagnosed: Any, work: Any) -> None:
        raise Asked(diagnosed.keywords, directory.config.reference)

    for module in ("battery", "conditions.battery"):
        monkeypatch.setattr(f"realitygap.studies.blind.{module}.do_missing", asked)
    shipped = shipped_file(ROBOT.name)
    assert shipped is not None
    monkeypatch.chdir(tmp_path)
    lab = Path(shutil.copy(shipped, tmp_path / "lab.json"))
    for given, told in (("mujoco", "mujoco"), (lab.name, str(lab)), (None, None)):
        with pytest.raises(Asked) as one:
            rg.blind(f"out-{given}", trials=1, reference=given, conditions=conditions)
        assert one.value.args == ({"reference": told}, told)


def test_a_reference_that_is_none_is_refused_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--reference"):
        rg.blind(tmp_path / "out", trials=1, reference=tmp_path / "nowhere.json")
    assert lasting_reference("none") == "none"


def test_one_job_on_a_labs_logs_starts_no_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that a script needs no guard."""
    logs = [log_file("healthy-search-no-light"), log_file("healthy-probe-spins-no-light")]
    monkeypatch.setattr("multiprocessing.process.BaseProcess.start", None)
    made = rg.measure_health(logs, out=tmp_path / "health.json", jobs=1)
    assert read_reference(tmp_path / "health.json").swarms == len(logs)
    assert made is not None

"""Whatever makes runs makes them in the engine that was asked for."""

from __future__ import annotations

import filecmp
import importlib.util
import json
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from realitygap.reality.engine import ENGINES, EngineName, installed
from realitygap.reality.rays import RAYS, RaysName
from realitygap.studies.blind.trials import blind_config
from realitygap.studies.blind.trials import plan as blind_plan
from realitygap.studies.demo import chapters
from realitygap.studies.demo.hide import draw
from realitygap.studies.demo.story import Size, Story
from realitygap.studies.gain.request import GainRequest
from realitygap.studies.gain.runs import plan as gain_plan
from realitygap.studies.health import reference
from realitygap.studies.health.reference import ReferenceRequest
from realitygap.studies.inputs.logs import sources
from realitygap.studies.inputs.model import Model
from realitygap.studies.paper.conditions import STUDIED, study_config
from realitygap.studies.paper.conditions import plan as study_plan
from realitygap.studies.run.experiment import RunConfig, simulate
from realitygap.studies.transfer.alterations import chosen
from realitygap.studies.transfer.plan import log_config, transfer_config
from realitygap.studies.transfer.plan import plan as transfer_plan
from tests.helpers import realitygap

ASKED: EngineName = "mujoco"
COMMANDS = (
    "run",
    "study paper",
    "study readings",
    "study transfer",
    "blind",
    "gain --log nothing --extended nothing --effect motor_lag:time_constant=0.1,robot=1",
    "demo",
    "reference --runs 1",
)


@pytest.mark.parametrize("command", COMMANDS)
def test_an_engine_that_is_not_installed_is_refused_in_one_line(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from realitygap.embedded_sim.errors import InputError
    from realitygap.studies.cli import app

    there = importlib.util.find_spec
    monkeypatch.setattr(
        "realitygap.reality.engine.find_spec",
        lambda name: None if name == "mujoco" else there(name),
    )
    words = [*command.split(), "--engine", "mujoco", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, words)
    assert isinstance(result.exception, InputError)
    assert "--engine: got 'mujoco', expected the extra [mujoco]" in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_an_unknown_engine_ends_with_two_and_one_line(tmp_path: Path) -> None:
    result = realitygap("run", "--engine", "bullet", "--out", tmp_path / "run")
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert (
        "--engine: got 'bullet', expected one of pybullet, pybullet-strict, mujoco" in result.stderr
    )


def test_a_run_in_mujoco_says_so_and_repeats_byte_for_byte(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    pieces = {}
    for name, engine in (("one", ASKED), ("again", ASKED), ("other", "pybullet")):
        out = pieces[name] = tmp_path / name
        out.mkdir()
        config = RunConfig.model_validate(
            {"minutes": 1.2, "robots": 5, "seed": 3, "engine": engine}
        )
        simulate(config, ("command_latency:seconds=0.013,robot=1",), out)
    notes = json.loads((pieces["one"] / "run.json").read_text(encoding="utf-8"))
    assert notes["config"]["engine"] == "mujoco"
    assert notes["versions"]["mujoco-core"]
    for table in ("samples", "generations", "deposits"):
        file = f"{table}.parquet"
        assert filecmp.cmp(pieces["one"] / file, pieces["again"] / file, shallow=False)
    samples = [pieces[name] / "samples.parquet" for name in ("one", "other")]
    assert not filecmp.cmp(*samples, shallow=False)


def test_unknown_rays_end_with_two_and_one_line(tmp_path: Path) -> None:
    result = realitygap("run", "--rays", "exact", "--out", tmp_path / "run")
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert "--rays: got 'exact', expected one of engine, closed" in result.stderr


def test_closed_rays_change_infrared_in_pybullet_and_nothing_in_mujoco(tmp_path: Path) -> None:
    """A manoeuvre: what it does depends on no sensor. MuJoCo's own rays are the closed form."""
    for engine in (one for one in ENGINES if installed(one)):
        seen = {}
        for rays in RAYS:
            out = tmp_path / engine / rays
            out.mkdir(parents=True)
            asked = {"minutes": 0.4, "controller": "probe:tour", "robots": 4, "seed": 3}
            config = RunConfig.model_validate({**asked, "engine": engine, "rays": rays})
            simulate(config, (), out)
            notes = json.loads((out / "run.json").read_text(encoding="utf-8"))
            assert notes["config"]["rays"] == rays
            seen[rays] = pd.read_parquet(out / "samples.parquet")
        infrared = [f"ps{i}" for i in range(8)]
        one, other = seen["engine"], seen["closed"]
        assert one.drop(columns=infrared).equals(other.drop(columns=infrared))
        assert one[infrared].equals(other[infrared]) == (engine == "mujoco")


def planned(engine: EngineName, rays: RaysName) -> dict[str, set[tuple[str, str]]]:
    """Engines and rays of the runs that each command plans."""
    asked = {"engine": engine, "rays": rays}
    blind = blind_plan(blind_config(trials=3, effects=("motor_lag",), **asked))
    study = study_plan(study_config(runs=1, **asked), STUDIED)
    alterations = chosen(("half-blind",), "light-at-nest", 10)
    transfer = transfer_config(alterations=alterations, runs=1, **asked)
    story = Story(1, Size(), draw(1), engine, rays)
    gain = gain_plan((), runs=2, minutes=1.0, robots=3, seed=1, engine=engine, rays=rays)
    configs = {
        "blind": [trial.run for trial in blind],
        "study": [run.config for run in study],
        "transfer": [run.config for run in transfer_plan(transfer)],
        "transfer's log": [log_config(transfer, alterations[0])],
        "demo": [chapters._config(story, 0)],
        "gain": [run.config for run in gain],
    }
    return {name: {(one.engine, one.rays) for one in each} for name, each in configs.items()}


@pytest.mark.parametrize("rays", RAYS)
@pytest.mark.parametrize("engine", ENGINES)
def test_every_planned_run_is_of_the_engine_and_rays_asked_for(
    engine: EngineName, rays: RaysName
) -> None:
    assert all(found == {(engine, rays)} for found in planned(engine, rays).values())


def test_healthy_runs_for_a_reference_are_of_the_engine_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[RunConfig] = []
    monkeypatch.setattr(
        "realitygap.studies.run.experiment.simulate", lambda config, *rest: seen.append(config)
    )
    request = ReferenceRequest(runs=1, engines=("mujoco",), rays="engine", model=Model.load())
    reference._record((request, 0, reference.KINDS[0], tmp_path))
    assert [(config.engine, config.rays) for config in seen] == [("mujoco", "engine")]
    pooled = ReferenceRequest(runs=8, engines=("pybullet", "mujoco"), model=Model.load())
    for number in range(8):
        room = tmp_path / str(number)
        room.mkdir()
        reference._record((pooled, number, reference.KINDS[number % 4], room))
    assert [config.engine for config in seen[1:]] == 4 * ["pybullet"] + 4 * ["mujoco"]
    assert pooled.command.endswith("--engine pybullet --engine mujoco")


def test_what_a_user_would_type_names_an_engine_that_is_not_the_usual() -> None:
    log, model = sources("log"), Model.load()
    gain = {"logs": log, "extended": model, "effects": ("motor_lag",)}
    assert "--engine mujoco" in GainRequest(**gain, engine="mujoco").command
    assert "--engine" not in GainRequest(**gain).command
    assert "--rays engine" in GainRequest(**gain, rays="engine").command
    assert "--rays" not in GainRequest(**gain).command
    assert "--engine mujoco" in ReferenceRequest(runs=1, engines=("mujoco",), model=model).command
    assert "--engine" not in ReferenceRequest(logs=log, engines=("mujoco",), model=model).command
    assert "--rays engine" in ReferenceRequest(runs=1, rays="engine", model=model).command
    assert "--rays" not in ReferenceRequest(logs=log, rays="engine", model=model).command


def test_the_help_names_the_extra_that_an_engine_needs() -> None:
    done = realitygap("run", "--help")
    assert "[mujoco]" in done.stdout

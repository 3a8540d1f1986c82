from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.modelfile import load_models, read_model_file
from realitygap.models.naming.diagnosis import Diagnosis, Unexplained, as_json, extension
from realitygap.models.naming.engine.hypothesis import Term
from realitygap.models.naming.engine.value import Value
from realitygap.models.naming.findings import Evidence, Named
from realitygap.models.naming.health.reference import (
    DIRECTORY,
    HOME,
    WORLDS,
    Column,
    Reference,
    no_reference,
    read_reference,
    shipped_file,
    shipped_reference,
    write_reference,
)
from realitygap.models.naming.health.senses import beside, read_sense_reference
from realitygap.models.naming.proposal.menu import Option, Proposal
from realitygap.studies.diagnosis.words import verdict_sentence
from realitygap.studies.inputs.model import Model
from tests.helpers import ROOT


def named(*, rivals: tuple[Term, ...] = (), twins: tuple[Term, ...] = ()) -> Named:
    term = Term(causes()["motor_saturation"], "left")
    evidence = Evidence(
        term=term,
        coordinates=np.array([4.5]),
        covariance=np.array([[1e-4]]),
        gain=500.0,
        share=0.41,
        distance=9.0,
        rivals=rivals,
    )
    return Named(
        term=term,
        robots=(3,),
        whole_swarm=False,
        values=(Value("limit", 4.5, 4.4, 4.6, "rad/s"),),
        evidence=evidence,
        twins=twins,
    )


LAG = Term(causes()["motor_lag"], "")
LEFT = Unexplained(channel="speed", share=0.2, where="somewhere", robots=(1,), distance=8.0)


@pytest.mark.parametrize(
    ("found", "verdict"),
    [
        (Diagnosis(named=()), "nothing_wrong"),
        (Diagnosis(named=(named(),)), "named"),
        (Diagnosis(named=(named(rivals=(LAG,)),)), "ambiguous"),
        (Diagnosis(named=(named(twins=(LAG,)),)), "ambiguous"),
        (Diagnosis(named=(named(),), unexplained=(LEFT,)), "unexplained"),
        (Diagnosis(named=(), unexplained=(LEFT,)), "unexplained"),
    ],
)
def test_the_verdict_follows_from_what_was_found(found: Diagnosis, verdict: str) -> None:
    assert found.verdict == verdict
    assert as_json(found)["verdict"] == verdict
    assert verdict_sentence(found)


def test_the_json_says_what_for_whom_how_large_and_what_else() -> None:
    proposal = Proposal(
        separates=("motor_saturation", "motor_lag"),
        options=(
            Option(name="steps", separation=30.0),
            Option(name="circle", separation=0.5),
        ),
    )
    found = Diagnosis(named=(named(rivals=(LAG,)),), proposal=proposal)
    content = json.loads(json.dumps(as_json(found)))
    cause = content["causes"][0]
    assert cause["name"] == "motor_saturation"
    assert cause["robots"] == [3]
    limit = {"value": 4.5, "low": 4.4, "high": 4.6, "unit": "rad/s"}
    assert cause["parameters"]["limit"] == limit
    assert cause["parameters"]["wheel"]["value"] == "left"
    assert cause["evidence"]["held_out_gain"] == 0.41
    assert cause["alternatives"] == ["motor_lag"]
    following = content["next_experiment"]
    assert following["name"] == "steps"
    assert following["separates"] == ["motor_saturation", "motor_lag"]
    assert [one["name"] for one in following["menu"]] == ["steps", "circle"]


def test_an_extended_model_loads_and_holds_what_was_named(tmp_path: Path) -> None:
    minimal = read_model_file("epuck")
    found = extension(Diagnosis(named=(named(),)), log_hash="ab12", command='say "diagnose"')
    Model.load("epuck").extended(found).keep(tmp_path)
    extended = read_model_file(tmp_path / "extended.toml")
    assert extended.extension == found
    assert extended.motion(3).drive.speed_limit == (4.5, math.inf)
    assert extended.motion(4) == minimal.motion(4)
    swarm = load_models(tmp_path / "extended.toml", 5)
    assert swarm[3].drive == extended.motion(3).drive
    assert swarm[4].drive == minimal.point_model().drive


def test_a_second_extension_keeps_the_first(tmp_path: Path) -> None:
    found = extension(Diagnosis(named=(named(),)), log_hash="", command="")
    Model.load("epuck").extended(found).keep(tmp_path)
    Model.load(tmp_path / "extended.toml").extended(found).write(tmp_path / "again")
    twice = read_model_file(tmp_path / "again" / "extended.toml").extension
    assert twice is not None
    assert len(twice.causes) == 2


def test_the_shipped_reference_belongs_to_the_shipped_robot() -> None:
    model = read_model_file("epuck")
    found = shipped_reference(model.name)
    assert found is not None
    assert found.wheel_radius == model.robot.wheel_radius
    assert found.robots >= 50
    assert shipped_reference("no such robot") is None


@pytest.mark.parametrize("world", WORLDS)
def test_a_shipped_reference_is_of_its_world_and_made_as_the_makefile_says(world: str) -> None:
    recipe = (ROOT / "Makefile").read_text(encoding="utf-8")
    for manoeuvres in (False, True):
        path = shipped_file("e-puck", world=world, manoeuvres=manoeuvres)
        assert path is not None
        assert path.parts[-2] == ("manoeuvres" if manoeuvres and world == HOME else world)
        found, senses = read_reference(path), read_sense_reference(beside(path))
        assert found.recorder == f"reality {world}"
        assert found.command == senses.command
        words = found.command.removeprefix("realitygap reference ")
        assert f"$(HEALTH)/{path.relative_to(DIRECTORY)} {words}\n" in recipe


def test_a_reference_survives_its_file(tmp_path: Path) -> None:
    names = ("motor_lag.time_constant", "speed/heading sin")
    column = Column(mean=0.0, sd=0.1, swarm_sd=0.05)
    drive = read_model_file("epuck").motion().drive
    made = no_reference("e-puck", drive).model_copy(
        update={
            "columns": dict.fromkeys(names, column),
            "causes": names[:1],
            "correlation": ((1.0,),),
        }
    )
    write_reference(made, tmp_path / "a.json")
    assert read_reference(tmp_path / "a.json") == made


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "JSON"),
        ("[]", r"r\.json: got \[\], expected a healthy reference"),
        ("{}", r"r\.json: model: got nothing, expected a value"),
        ('{"model": 3}', r"r\.json: model: got 3, expected a valid string"),
    ],
)
def test_what_is_no_reference_is_refused(text: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    path.write_text(text)
    with pytest.raises(InputError, match=says) as refusal:
        read_reference(path)
    assert "\n" not in str(refusal.value)


def test_an_unknown_key_of_a_reference_is_refused_with_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    write_reference(no_reference("m", read_model_file("epuck").motion().drive), path)
    path.write_text(path.read_text().replace('"margin"', '"margn"'))
    with pytest.raises(InputError, match=r"gates\.margn: .*did you mean margin"):
        read_reference(path)


def test_without_healthy_robots_the_minimal_model_is_health() -> None:
    motion = read_model_file("epuck").motion()
    unknown: Reference = no_reference("e-puck", motion.drive)
    assert unknown.motion(motion) == motion
    assert unknown.knows(["motor_lag.time_constant"]).all()
    assert unknown.learned.names == ()


@pytest.mark.parametrize(
    ("causes", "correlation", "says"),
    [
        (["a.b"], [[1.0]], r"causes: got 'a\.b', expected names in columns"),
        (["a.b", "c.d"], [[1.0, 0.0]], r"correlation: got rows of \[2\] numbers, expected 2 rows"),
        (["a.b"], [[1.0, 0.0]], r"correlation: got rows of \[2\] numbers, expected 1 rows"),
    ],
)
def test_a_reference_with_correlations_of_nothing_is_refused(
    causes: list[str], correlation: list[list[float]], says: str, tmp_path: Path
) -> None:
    path = tmp_path / "r.json"
    write_reference(no_reference("m", read_model_file("epuck").motion().drive), path)
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "causes": causes, "correlation": correlation}))
    with pytest.raises(InputError, match=says):
        read_reference(path)


def test_a_reference_of_another_schema_is_refused_with_what_makes_one(tmp_path: Path) -> None:
    old = json.loads((DIRECTORY / HOME / "e-puck.json").read_text("utf-8")) | {"schema_version": 1}
    (tmp_path / "old.json").write_text(json.dumps(old | {"terms": {}}), encoding="utf-8")
    with pytest.raises(InputError, match=r"schema_version: got 1, expected 2; make it anew"):
        read_reference(tmp_path / "old.json")

"""Whatever is written can be read back, whatever it is called."""

from __future__ import annotations

import os
from dataclasses import replace
from math import cos, sin
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from realitygap.embedded_sim import InputError
from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.belief.modelfile import (
    Arena,
    Circle,
    Lamps,
    ModelFile,
    Point,
    RobotSection,
    read_model_file,
)
from realitygap.models.belief.senses import SenseCause
from realitygap.models.log.formats.mapped import SCALES, Map, Origin, Poses, read_map
from realitygap.models.log.opened import json_values
from realitygap.models.log.schema import UNITS
from realitygap.models.naming.health.reference import (
    INHERENT,
    Column,
    Reference,
    read_reference,
    write_reference,
)
from realitygap.models.naming.health.senses import (
    Health,
    SenseReference,
    read_sense_reference,
    write_sense_reference,
)
from realitygap.reality.effects import HiddenEffect, catalogue, parse_effects
from realitygap.studies.gain.held_out import hidden_in
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.provenance import write_json
from realitygap.studies.plumbing.typed import typed
from realitygap.studies.run.experiment import RunConfig

often = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
texts = st.text(max_size=20) | st.sampled_from(
    ["\U0001f600", "\x00\x1b[31m", "\"'''\\", "\r\n", "#"]
)
names = st.binary(max_size=20).filter(lambda raw: b"\0" not in raw).map(os.fsdecode)
commands = st.lists(texts | names, max_size=4).map(lambda words: typed(*words))
finite = st.floats(allow_nan=False, allow_infinity=False)
lengths = st.floats(1e-6, 100.0)
places = st.floats(-100.0, 100.0)


@st.composite
def named_causes(draw: st.DrawFn) -> NamedCause:
    cause = every_cause()[draw(st.sampled_from(sorted(every_cause())))]
    some = st.lists(st.integers(0, 99), min_size=1, max_size=3, unique=True).map(tuple)
    robots: Any = draw(st.just("all") | some)
    if isinstance(cause, SenseCause) and cause.place:
        robots = "all"
    values = {}
    for p in (*cause.parameters, *cause.given):
        low, high = max(p.low, -1e300), min(p.high, 1e300)
        value = draw(st.floats(low, high) | st.sampled_from([low, high, p.null]))
        ends = sorted(draw(st.tuples(finite, finite)))
        bounds = draw(st.sampled_from([(None, None), tuple(ends), (ends[0], None)]))
        values[p.name] = ParameterValue(value=value, low=bounds[0], high=bounds[1], unit=p.unit)
    word = draw(st.sampled_from(cause.variants))
    return NamedCause(name=cause.name, robots=robots, word=word, parameters=values)


extensions = st.builds(
    Extension, log=texts, command=commands, causes=st.lists(named_causes(), max_size=3).map(tuple)
)
points = st.builds(Point, x=places, y=places)


@st.composite
def arenas(draw: st.DrawFn, body: float) -> Arena:
    """With room for a robot and, outside the nest, for food."""
    radius = body * draw(st.floats(2.0, 50.0))
    share = draw(st.floats(0.01, 0.5))
    away, angle = draw(st.floats(0.0, 0.9)) * radius, draw(st.floats(0.0, 6.3))
    nest = Circle(x=away * cos(angle), y=away * sin(angle), radius=share * (radius - body))
    return Arena(radius=radius, nest=nest)


@st.composite
def model_files(draw: st.DrawFn) -> ModelFile:
    body = draw(st.floats(1e-3, 1.0))
    plain = ModelFile(
        name=draw(texts.filter(bool)),
        robot=RobotSection(
            wheel_radius=draw(lengths),
            axle=draw(lengths),
            body_radius=body,
            wheel_speed_max=draw(st.floats(1e-6, 1000.0)),
        ),
        arena=draw(st.none() | arenas(body)),
        lamps=draw(st.builds(Lamps, opposite=st.none() | points, at_nest=st.none() | points)),
    )
    extended = plain.model_copy(update={"extension": draw(extensions)})
    return extended if possible(extended) else plain


def possible(model: ModelFile) -> bool:
    """Whether its causes together leave what tables and places hold."""
    try:
        ModelFile.model_validate(model.model_dump())
    except ValidationError:
        return False
    return True


@often
@given(model=model_files(), named=extensions)
def test_an_extended_model_is_read_back(tmp_path: Path, model: ModelFile, named: Extension) -> None:
    earlier = model.extension.causes if model.extension else ()
    whole = named.model_copy(update={"causes": (*earlier, *named.causes)})
    expected = model.model_copy(update={"extension": whole})
    if not possible(expected):
        with pytest.raises(InputError):
            Model(model).extended(named)
        return
    Model(model).extended(named).keep(tmp_path)
    assert read_model_file(tmp_path / "extended.toml") == expected


@often
@given(name=texts.filter(bool), named=extensions)
def test_an_extended_model_keeps_its_sensors(tmp_path: Path, name: str, named: Extension) -> None:
    model = Model.load()
    called = replace(model, file=model.file.model_copy(update={"name": name}))
    if not possible(called.file.model_copy(update={"extension": named})):
        with pytest.raises(InputError):
            called.extended(named)
        return
    called.extended(named).keep(tmp_path)
    back = read_model_file(tmp_path / "extended.toml")
    assert back.sensors is not None
    assert (tmp_path / back.sensors.tables).is_file()
    assert back.extension == named
    assert back.name == name


@st.composite
def sources(draw: st.DrawFn, column: str) -> Origin | str:
    units = [None, *SCALES.get(UNITS[column], {})]
    if column == "cmd_omega":
        units.remove("steps/s")
    told = {"from": draw(texts), "unit": draw(st.sampled_from(units)), "scale": draw(finite)}
    return draw(st.just(Origin.model_validate(told)) | texts)


@st.composite
def maps(draw: st.DrawFn) -> Map:
    chosen = draw(st.lists(st.sampled_from(sorted(UNITS)), unique=True, max_size=6))
    paths = st.text(st.characters(codec="utf-8"), max_size=20).map(Path)
    poses = st.builds(Poses, file=paths, t=sources("t"))
    columns = {name: draw(sources(name)) for name in chosen}
    return Map(columns=columns, poses=draw(st.none() | poses))


@often
@given(chosen=maps())
def test_a_map_is_read_back(tmp_path: Path, chosen: Map) -> None:
    path = tmp_path / "map.toml"
    content = chosen.model_dump(mode="json", by_alias=True, exclude_none=True)
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    assert read_map(path) == chosen


def spreads(size: int) -> st.SearchStrategy[Health]:
    number = st.lists(finite, min_size=size, max_size=size).map(tuple)
    fields = dict.fromkeys(("mean", "sd", "swarm_mean", "swarm_sd"), number)
    more = {"gain": finite, "swarm_gain": finite}
    return st.builds(Health, **fields, farthest=finite, swarm_farthest=finite, **more)


def inherent(size: int) -> st.SearchStrategy[tuple[float, ...]]:
    return st.lists(finite, min_size=size, max_size=size).map(tuple)


@st.composite
def references(draw: st.DrawFn) -> Reference:
    """Of motion, of any coefficients."""
    column = st.builds(Column, mean=finite, sd=finite, swarm_sd=finite)
    columns = draw(st.dictionaries(texts, column, max_size=5))
    some = tuple(name for name in columns if draw(st.booleans()))
    row = st.tuples(*[finite] * len(some))
    return Reference(
        model=draw(texts),
        wheel_radius=draw(finite),
        axle=draw(finite),
        robots=draw(st.integers(0, 10**6)),
        swarms=draw(st.integers(0, 10**6)),
        inherent=draw(inherent(len(INHERENT.parameters))),
        columns=columns,
        causes=some,
        correlation=draw(st.tuples(*[row] * len(some))),
        command=draw(commands),
    )


@often
@given(reference=references())
def test_a_reference_is_read_back(tmp_path: Path, reference: Reference) -> None:
    write_reference(reference, tmp_path / "r.json")
    assert read_reference(tmp_path / "r.json") == reference


@often
@given(
    reference=st.builds(
        SenseReference,
        model=texts,
        robots=st.integers(0, 10**6),
        swarms=st.integers(0, 10**6),
        columns=st.dictionaries(
            texts, st.builds(Column, mean=finite, sd=finite, swarm_sd=finite), max_size=5
        ),
        command=commands,
    )
)
def test_a_reference_of_the_senses_is_read_back(tmp_path: Path, reference: SenseReference) -> None:
    write_sense_reference(reference, tmp_path / "r.json")
    assert read_sense_reference(tmp_path / "r.json") == reference


@often
@given(
    config=st.builds(
        RunConfig,
        minutes=st.floats(1e-6, 1440.0),
        seed=st.integers(0, 2**63 - 1),
        robots=st.integers(1, 100),
        model=st.none() | texts,
        samples=st.booleans(),
    )
)
def test_a_runs_configuration_is_read_back(tmp_path: Path, config: RunConfig) -> None:
    write_json(tmp_path / "run.json", {"config": config.model_dump()})
    back = json_values(tmp_path / "run.json", "a run")
    assert RunConfig.model_validate(back["config"]) == config


@st.composite
def specs(draw: st.DrawFn) -> str:
    effect = catalogue()[draw(st.sampled_from(sorted(catalogue())))]
    items = []
    for key, p in effect.parameters.items():
        if p.words:
            items.append(f"{key}={draw(st.sampled_from(p.words))}")
        else:
            low, high = max(p.low, -1e300), min(p.high, 1e300)
            items.append(f"{key}={draw(st.floats(low, high))!r}")
    if effect.per_robot:
        items += [f"robot={k}" for k in draw(st.lists(st.integers(0, 9), max_size=3))]
    return f"{effect.name}:" + ",".join(items)


@often
@given(given=st.lists(specs(), max_size=3))
def test_what_was_hidden_is_read_back(tmp_path: Path, given: list[str]) -> None:
    hidden: tuple[HiddenEffect, ...] = parse_effects(given, 10)
    write_json(tmp_path / "truth.json", {"effects": [one.truth() for one in hidden]})
    assert hidden_in(tmp_path) == hidden

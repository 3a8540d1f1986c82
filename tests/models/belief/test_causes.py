from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from realitygap.embedded_sim import Drive, InputError
from realitygap.models.belief.catalogue import causes
from realitygap.models.belief.cause import Cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.models.belief.modelfile import ModelFile, RobotSection, read_model_file
from realitygap.models.belief.motion import Motion

BASE = Motion(drive=Drive(time_constant=0.01, acceleration=(150.0, 150.0)))
NAMES = sorted(causes())


def null(cause: Cause) -> np.ndarray:
    return np.array([p.null for p in cause.parameters])


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("base", [Motion(), BASE], ids=["minimal", "healthy"])
def test_a_cause_at_its_null_changes_no_bit_of_a_motion(name: str, base: Motion) -> None:
    cause = causes()[name]
    for variant in cause.variants:
        assert cause.change(base, null(cause), variant) == base


@pytest.mark.parametrize("name", [n for n in NAMES if causes()[n].identifiable])
def test_a_cause_away_from_its_null_changes_the_motion(name: str) -> None:
    cause = causes()[name]
    starts = cause.starts(np.array([[6.0, 3.0], [0.5, 6.0]]))
    steps = starts or [np.array([5 * p.step for p in cause.parameters])]
    for variant in cause.variants:
        assert any(cause.applied(BASE, u, variant) != BASE for u in steps)


@pytest.mark.parametrize("name", NAMES)
def test_a_cause_has_a_meaning_bounds_around_its_null_and_an_experiment(name: str) -> None:
    cause = causes()[name]
    assert cause.name == name
    assert cause.meaning
    assert cause.experiment
    for p in cause.parameters:
        assert p.low < p.high
        assert p.low <= p.null <= p.high or math.isinf(p.null)
    for twin in cause.twins:
        assert name in causes()[twin].twins


@given(st.sampled_from(NAMES), st.floats(-0.5, 0.5))
def test_a_coordinate_survives_the_way_to_a_value_and_back(name: str, u: float) -> None:
    for p in causes()[name].parameters:
        assert p.coordinate(p.value(u)) == pytest.approx(u, abs=1e-9)
        if math.isfinite(p.null):
            assert p.value(0.0) == p.null


def test_every_motion_effect_has_a_cause_with_the_same_keys() -> None:
    from realitygap.reality.effects import catalogue

    for name, effect in catalogue().items():
        if name in causes():
            cause = causes()[name]
            keys = {p.name for p in cause.parameters} | ({cause.word} if cause.word else set())
            assert keys == set(effect.parameters), name


def test_an_extension_at_its_null_is_the_minimal_model() -> None:
    minimal = read_model_file("epuck")
    named = tuple(
        NamedCause(
            name=name,
            word=cause.variants[0],
            parameters={p.name: ParameterValue(value=p.null) for p in cause.parameters},
        )
        for name, cause in causes().items()
        if all(math.isfinite(p.null) for p in cause.parameters)
    )
    extended = minimal.model_copy(update={"extension": Extension(causes=named)})
    assert extended.motion(3) == minimal.motion(3)
    assert extended.point_model().drive == minimal.point_model().drive


def test_an_extension_concerns_its_robots_only() -> None:
    cause = NamedCause(
        name="motor_saturation",
        robots=(3,),
        word="left",
        parameters={"limit": ParameterValue(value=4.5)},
    )
    model = ModelFile(
        name="x",
        robot=RobotSection(wheel_radius=0.02, axle=0.05, body_radius=0.03, wheel_speed_max=6.0),
        extension=Extension(causes=(cause,)),
    )
    assert model.motion(3).drive.speed_limit == (4.5, math.inf)
    assert model.motion(2) == model.motion()
    assert model.motion(2).drive.speed_limit == (math.inf, math.inf)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('name = "motor_lagg"', "motor_lag"),
        ("seconds = { value = 0.1 }", "time_constant"),
        ("time_constant = { value = 99.0 }", "from -0.1 to 1 s"),
        ('word = "left"', "word"),
        ("colour = 3", "unknown key"),
    ],
)
def test_a_broken_extension_is_refused_with_what_is_valid(
    change: str, said: str, tmp_path: Path
) -> None:
    lines = {"name": 'name = "motor_lag"', "parameters": "time_constant = { value = 0.1 }"}
    if change.startswith("name"):
        lines["name"] = change
    elif "value" in change:
        lines["parameters"] = change
    else:
        lines["name"] += "\n" + change
    text = (
        'name = "x"\n[robot]\nwheel_radius = 0.02\naxle = 0.05\nbody_radius = 0.03\n'
        "wheel_speed_max = 6.0\n[extension]\n[[extension.causes]]\n"
        f"{lines['name']}\n[extension.causes.parameters]\n{lines['parameters']}\n"
    )
    path = tmp_path / "broken.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_model_file(path)

"""Curves of what wheels do, as model files have them."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.belief.extended import extended_text, read_back
from realitygap.models.belief.extension import Extension
from realitygap.models.belief.law_tables import DoneCurve
from realitygap.models.belief.modelfile import read_model_file

OURS = DoneCurve(robots=(3,), wheel="left", told=(-6.0, 0.0, 6.0), done=(-5.0, 0.0, 5.5))


def test_a_curve_concerns_its_robots_and_its_wheel_alone() -> None:
    model = read_model_file("epuck").model_copy(update={"extension": Extension(done_curve=(OURS,))})
    assert model.motion(3).drive.done_curve == (((-6.0, -5.0), (0.0, 0.0), (6.0, 5.5)), ())
    assert model.motion(2) == read_model_file("epuck").motion(2)
    assert model.extension is not None
    assert model.extension.robots == [3]


def test_a_curve_survives_its_file() -> None:
    model = read_model_file("epuck")
    text = extended_text(model, Extension(done_curve=(OURS,)))
    assert tomllib.loads(text)["extension"]["done_curve"][0]["told"] == [-6.0, 0.0, 6.0]
    again = read_back(text)
    assert again.extension is not None
    assert again.extension.done_curve == (OURS,)
    assert again.motion(3).drive.struct().knots[0] == 3


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("told = [0.0, 1.0]\ndone = [0.0]", "done: got 1 speeds, expected 2, as many as told"),
        ("told = [1.0, 0.0]\ndone = [0.0, 1.0]", "told"),
        ("told = [0.0, 1.0]\ndone = [1.0, 0.0]", "done"),
        ("told = [0.0]\ndone = [0.0]", "knots"),
        ('told = [0.0, 1.0]\ndone = [0.0, 1.0]\nwheel = "front"', "wheel"),
    ],
)
def test_a_curve_that_is_none_is_refused_by_the_name_of_its_key(
    lines: str, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "m.toml"
    path.write_text(
        'name = "x"\n[robot]\nwheel_radius = 0.02\naxle = 0.05\nbody_radius = 0.03\n'
        f"wheel_speed_max = 6.0\n[[extension.done_curve]]\n{lines}\n"
    )
    with pytest.raises(InputError, match=said):
        read_model_file(path)

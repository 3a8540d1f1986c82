"""Laws in a model file: read, checked, and given to the robots that have them."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

import realitygap as rg
from realitygap.embedded_sim import InputError
from realitygap.embedded_sim.laws import Atom, Law
from realitygap.models.belief.extended import extended_text, read_back
from realitygap.models.belief.extension import Extension
from realitygap.models.belief.modelfile import read_model_file
from realitygap.models.gap.conditions import carried_on
from tests.helpers import realitygap

LAW: dict[str, Any] = {
    "channel": "turn",
    "robots": [1, 2],
    "unit": "rad/s",
    "atoms": [{"of": "heading", "form": "cosine", "parameters": [1.0, 0.5]}],
    "amplitudes": [
        {"robot": 1, "value": 0.1, "low": 0.09, "high": 0.11},
        {"robot": 2, "value": 0.0},
    ],
}


def text(**changes: Any) -> str:
    """A model file with the law."""
    content = tomllib.loads(extended_text(read_model_file(), Extension(log="x")))
    content["extension"]["laws"] = [{**LAW, **changes}]
    del content["sensors"]  # motion alone, so that it may lie anywhere
    return tomli_w.dumps(content)


def test_each_robot_has_its_amplitude_and_others_none() -> None:
    file = read_back(text())
    atom = Atom("heading", "cosine", (1.0, 0.5))
    assert file.motion(1).drive.laws == (Law("turn", 0.1, (atom,)),)
    assert file.motion(1).drive.reach == pytest.approx(0.565)
    minimal = read_model_file().motion()
    assert file.motion(2) == file.motion(0) == file.motion() == minimal
    assert file.extension is not None
    assert file.extension.robots == [1, 2]


def test_what_the_whole_swarm_has_is_everybodys() -> None:
    file = read_back(text(robots="all", amplitudes=[{"value": 0.2}, {"robot": 1, "value": 0.1}]))
    assert [file.motion(robot).drive.laws[0].amplitude for robot in (0, 1, None)] == [0.2, 0.1, 0.2]


def test_a_file_is_written_and_read_back_alike() -> None:
    file = read_back(text())
    assert file.extension is not None
    again = read_back(extended_text(read_model_file(), file.extension))
    assert again.extension is not None
    assert again.extension.laws == file.extension.laws


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"channel": "sideways"}, "channel"),
        ({"unit": "1"}, "unit"),
        ({"robots": [1, 3]}, "amplitudes"),
        ({"robots": "all"}, "amplitudes"),
        ({"atoms": [{"of": "left_angle", "form": "cosine", "parameters": [1.0, 0.0]}]}, "of"),
        ({"atoms": [{"of": "gap", "form": "log"}]}, "form"),
        ({"atoms": [{"of": "gap", "form": "fade", "parameters": [0.0]}]}, "drive.laws scale"),
        ({"amplitudes": [{"robot": 1, "value": float("inf")}]}, "amplitudes"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(changes: Any, expected: str) -> None:
    with pytest.raises(InputError, match=expected) as refused:
        read_back(text(**changes))
    assert "\n" not in str(refused.value)


def test_rows_without_a_pose_have_the_one_before_them() -> None:
    seen = np.arange(12.0).reshape(6, 2)
    known = np.array([False, True, False, False, False, False])
    found = carried_on(seen, known, np.array([0, 4, 6]))
    assert found.tolist() == [[2, 3], [2, 3], [2, 3], [2, 3], [0, 0], [0, 0]]


def test_the_command_prints_equations(tmp_path: Path) -> None:
    path = tmp_path / "extended.toml"
    path.write_text(text())
    laws = rg.Model.load(path).laws
    assert laws["equation"].tolist() == ["Ω += a · cos(ψ − 0.5)"] * 2
    assert laws["value"].tolist() == [0.1, 0.0]
    told = realitygap("laws", path).stdout
    assert "Ω += a · cos(ψ − 0.5)" in told
    assert r"LaTeX: \Omega \mathrel{+}= a \, \cos(\psi - 0.5)" in told
    assert "robot 1: a = 0.1 rad/s (0.09 to 0.11)" in told
    as_json = json.loads(realitygap("laws", path, "--json").stdout)
    assert [one["robot"] for one in as_json] == [1, 2]


def test_a_model_without_laws_says_so() -> None:
    done = realitygap("laws", "epuck")
    assert done.returncode == 0
    assert "has no laws" in done.stdout

"""The engine's artefacts are as large as the documentation says."""

from __future__ import annotations

import pytest

from realitygap.reality.engine import ENGINES, EngineName, installed
from realitygap.studies.measure.artefacts import Setting, analytic_stop, figures
from realitygap.studies.measure.convergence import CHOSEN
from tests.helpers import ROOT


def documented(setting: Setting, heading: str) -> dict[str, float]:
    """The row of a setting, of the table whose head holds the heading."""
    lines = (ROOT / "docs" / "convergence.md").read_text(encoding="utf-8").splitlines()
    head = next(i for i, line in enumerate(lines) if heading in line)
    names, values = (
        [cell.strip() for cell in line.split("|")[4:-1]]
        for line in (lines[head], next(x for x in lines[head:] if x.startswith(setting.cells)))
    )
    return dict(zip(names, map(float, values), strict=True))


@pytest.mark.parametrize("name", ENGINES)
def test_the_artefacts_are_as_large_as_documented(name: EngineName) -> None:
    if not installed(name):
        pytest.skip(f"{name} is not installed")
    found = figures(CHOSEN[name])
    expected = documented(CHOSEN[name], "creep at rest: mean")
    # what is not there at all is the last digits of 1
    assert found == pytest.approx(expected, rel=0.02, abs=1e-3)


@pytest.mark.parametrize("name", ["pybullet-strict", "mujoco"])
def test_strict_engines_do_nothing_that_no_robot_does(name: EngineName) -> None:
    if not installed(name):
        pytest.skip(f"{name} is not installed")
    found = figures(CHOSEN[name])
    assert abs(found["largest (mm/s)"]) < 0.01
    assert found["stop (mm)"] == pytest.approx(1e3 * analytic_stop(), rel=0.05)
    assert found["10 s later (mm/s)"] == pytest.approx(
        found["free roll: at first (mm/s)"], rel=1e-3
    )
    assert abs(found["momentum gained (%)"]) < 1.0
    assert found["tilt: creep at rest (mm/s)"] < 0.1


def test_a_stop_by_hand_is_that_of_torque_against_body_and_rotors() -> None:
    """Half of v^2 over the deceleration, written out: 0.1976 kg, 0.7415 N, 0.123 m/s."""
    assert analytic_stop() == pytest.approx(0.123**2 * 0.1976 / (2.0 * 0.7415), rel=1e-3)

"""The engine's artefacts are as large as the documentation says."""

from __future__ import annotations

import pytest

from realitygap.studies.artefacts import analytic_stop, figures
from realitygap.studies.convergence import CHOSEN
from tests.helpers import ROOT


def documented(heading: str) -> dict[str, float]:
    """The row of the setting in use, of the table whose head begins so."""
    lines = (ROOT / "docs" / "convergence.md").read_text(encoding="utf-8").splitlines()
    head = next(i for i, line in enumerate(lines) if heading in line)
    names, values = ([c.strip() for c in lines[i].split("|")[1:-1]] for i in (head, head + 2))
    row = dict(zip(names, map(float, values), strict=True))
    assert (row.pop("step (ms)"), row.pop("iterations")) == (1e3 * CHOSEN.step, CHOSEN.iterations)
    return row


def test_the_artefacts_are_as_large_as_documented() -> None:
    found = figures(CHOSEN.step, CHOSEN.iterations)
    assert found == pytest.approx(documented("creep at rest: mean"), rel=0.02)


def test_a_stop_by_hand_is_that_of_torque_against_body_and_rotors() -> None:
    """Half of v^2 over the deceleration, written out: 0.1976 kg, 0.7415 N, 0.123 m/s."""
    assert analytic_stop() == pytest.approx(0.123**2 * 0.1976 / (2.0 * 0.7415), rel=1e-3)

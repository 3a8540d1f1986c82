"""The worlds that reality can be tested in."""

from __future__ import annotations

import pytest

from realitygap.reality.engine import ENGINES, EngineName, installed
from tests.reality import hidden


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> EngineName:
    """Each engine in turn; the worlds of `hidden` are of this one meanwhile."""
    name: EngineName = request.param
    if not installed(name):
        pytest.skip(f"{name} is not installed")
    monkeypatch.setattr(hidden, "ENGINE", name)
    return name

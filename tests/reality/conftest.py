"""The worlds that reality can be tested in."""

from __future__ import annotations

from importlib.util import find_spec

import pytest

from realitygap.reality.engine import ENGINES, EngineName
from tests.reality import hidden


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> EngineName:
    """Each engine in turn; the worlds of `hidden` are of this one meanwhile."""
    name: EngineName = request.param
    if find_spec(name) is None:
        pytest.skip(f"{name} is not installed")
    monkeypatch.setattr(hidden, "ENGINE", name)
    return name

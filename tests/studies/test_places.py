"""What a cause of the catalogue needs, place by place: whoever adds one is told what is missing."""

from __future__ import annotations

import json
import math

import pytest

from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.senses import SenseCause
from realitygap.reality.effects import catalogue
from realitygap.studies.hidden.menu import MENU
from tests.golden.answers import answer_file, log_file
from tests.golden.plan import plan
from tests.helpers import ROOT

ELSEWHERE = {n for n, c in every_cause().items() if c.where in ("skid", "unmeasured")}
"""Causes of other robots than those of the physical world, and of logs without a reference."""
NAMES = sorted({*catalogue(), *every_cause(), *MENU} - ELSEWHERE)


UNMEASURED = "not named, for the healthy reference"
"""How a diagnosis says that a cause is not in its reference."""


def places(name: str) -> dict[str, bool]:
    """What an effect with its cause needs, in order, and whether it is there."""
    document = (ROOT / "docs" / "effects.md").read_text(encoding="utf-8")
    physics = [p.read_text(encoding="utf-8") for p in (ROOT / "tests/reality").glob("test_*.py")]
    kept = {n for n, one in plan().items() if name in {h.name for h in one.trial.hidden}}
    logs = sorted({f"single-{name}", *kept})
    said = [answer_file(n).read_text("utf-8") for n in logs if answer_file(n).is_file()]
    notes = [note for text in said for note in json.loads(text)["not_checked"]]
    unmeasured = [note for note in notes if UNMEASURED in note and name in note]
    return {
        "an effect in reality/effects, which hides it": name in catalogue(),
        "a cause in models/belief/causes, which believes it": name in every_cause(),
        "its sentence, `plain` of the cause": bool(
            name in every_cause() and every_cause()[name].plain
        ),
        f'its entry "{name}" of MENU in studies/hidden/menu.py': name in MENU,
        f'a test of its physics, with "{name}:...", in tests/reality': any(
            f'"{name}:' in text for text in physics
        ),
        "its row: realitygap effects --out docs/effects.md --force": f"| `{name}`" in document,
        "health with it: make references": (bool(said) and not unmeasured),
        f"python -m tests.golden logs {' '.join(logs)}": all(log_file(n).is_file() for n in logs),
        "python -m tests.golden answers": len(said) == len(logs),
    }


def missing(name: str) -> str:
    """Every place that lacks a cause, a line each; empty: none does."""
    absent = [place for place, there in places(name).items() if not there]
    return "\n".join([f"{name} still needs:", *absent]) if absent else ""


@pytest.mark.parametrize("name", NAMES)
def test_a_cause_is_in_every_place(name: str) -> None:
    if absent := missing(name):
        pytest.fail(absent, pytrace=False)


def test_a_cause_that_is_nowhere_is_missed_in_every_place() -> None:
    assert len(missing("narrow_tread").splitlines()) == 1 + len(places("narrow_tread"))


@pytest.mark.parametrize("name", sorted(set(catalogue()) & set(every_cause())))
def test_an_effect_and_its_cause_have_the_same_parameters_place_and_null(name: str) -> None:
    effect, cause = catalogue()[name], every_cause()[name]
    words = [cause.word] if cause.word else []
    assert sorted(effect.parameters) == sorted([*(p.name for p in cause.parameters), *words])
    if isinstance(cause, SenseCause):
        assert cause.place is not effect.per_robot
    changes_nothing = [p.null is not None for p in effect.parameters.values()]
    assert any(changes_nothing) == any(math.isfinite(p.null) for p in cause.parameters)

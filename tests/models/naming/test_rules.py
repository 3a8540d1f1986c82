"""What naming was tuned to stands in one place, is asked for there, and decides."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

import pytest

from realitygap.embedded_sim import InputError
from realitygap.models.naming.engine.gates import Gates
from realitygap.models.naming.rules import Rules, listed
from tests.helpers import ROOT

NOT = re.compile(r"\bNo rule\b")
ALL = "No rule, as all numbers here"


def modules() -> list[Path]:
    """All that naming is made of."""
    return sorted((ROOT / "models" / "naming").rglob("*.py"))


def unsaid(source: str) -> Iterator[str]:
    """Constants that are numbers and do not say that they are no rules."""
    body = ast.parse(source).body
    if ALL in source:
        return
    for one, after in zip(body, [*body[1:], None], strict=True):
        if not isinstance(one, ast.Assign) or not isinstance(one.targets[0], ast.Name):
            continue
        if isinstance(one.value, ast.Call) and isinstance(one.value.func, ast.Name):
            continue  # an object, not a number
        inside = list(ast.walk(one.value))
        places = {
            n for each in inside if isinstance(each, ast.Subscript) for n in ast.walk(each.slice)
        }
        numbers = [
            n
            for n in inside
            if isinstance(n, ast.Constant) and isinstance(n.value, int | float) and n not in places
        ]
        text = after.value if isinstance(after, ast.Expr) else None
        told = text.value if isinstance(text, ast.Constant) else ""
        if numbers and not NOT.search(str(told)):
            yield one.targets[0].id


def test_there_are_at_most_sixty_and_each_says_what_it_is() -> None:
    rules = list(listed(Rules()))
    assert len(rules) <= 60
    for one in rules:
        assert one.unit
        assert one.reason
        assert re.match(r"our choice|derived: |measured: ", one.origin), one.name


@pytest.mark.parametrize("path", modules(), ids=lambda path: str(path.relative_to(ROOT)))
def test_a_number_of_a_module_is_a_rule_or_says_that_it_is_none(path: Path) -> None:
    assert list(unsaid(path.read_text(encoding="utf-8"))) == [], (
        "put it into models/naming/rules.py, or say 'No rule' and why below it"
    )


def test_every_rule_is_asked_for() -> None:
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "models").rglob("*.py")]
    asked = {name for text in texts for name in re.findall(r"\b[Rr]ules\.(\w+)", text)}
    assert {one.name for one in fields(Rules)} - asked == set()


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("price", -1.0, "a finite number >= 0"),
        ("price", float("nan"), "a finite number >= 0"),
        ("price", float("inf"), "a finite number >= 0"),
        ("price", "4", "a finite number >= 0"),
        ("row_freedom", 0.0, "a finite number > 0"),
        ("wild_blocks", 0, "a whole number > 0"),
        ("again", 1.5, "a whole number >= 0"),
        ("again", True, "a whole number >= 0"),
        ("most_items", 0, "a whole number > 0"),
    ],
)
def test_what_no_rule_can_be_is_refused(name: str, value: object, expected: str) -> None:
    with pytest.raises(InputError, match=rf"^rules\.{name}: .*{expected}$"):
        replace(Rules(), **{name: value})


def test_a_gate_that_healthy_robots_raised_is_lowered_by_nobody() -> None:
    low, high = Rules(cause_gate=10.0, error_gate=2.0), Rules(cause_gate=90.0, error_gate=99.0)
    raised = Gates(error=12.0)
    assert (raised.under(low).cause, raised.under(low).error) == (10.0, 12.0)
    assert (raised.under(high).cause, raised.under(high).error) == (90.0, 99.0)
    assert raised.under(Rules()) == raised

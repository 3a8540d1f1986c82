"""A class has a name of its own: who reads a name need not ask of which room it is."""

from __future__ import annotations

import ast
from collections import Counter

from tests.helpers import ROOT

ROOMS = ("embedded_sim", "reality", "models", "studies")


def test_no_two_classes_have_the_same_name() -> None:
    """But for private ones."""
    names = Counter(
        node.name
        for room in ROOMS
        for path in (ROOT / room).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert len(names) > 100
    assert [name for name, count in names.items() if count > 1] == []

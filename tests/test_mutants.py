"""The list of changes that tests must notice is kept with the code it changes."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from tests import mutants


def test_every_change_of_the_list_applies_once_and_has_its_tests() -> None:
    assert mutants.stale(mutants.read()) == []


def test_the_list_reaches_every_room() -> None:
    listed = mutants.read()
    rooms = [one.file.split("/")[0] for one in listed]
    assert len(listed) >= 60
    assert min(rooms.count(room) for room in ("embedded_sim", "reality", "models", "studies")) >= 10


def test_a_list_that_no_longer_fits_is_told_line_by_line() -> None:
    one = mutants.read()[0]
    bad = [
        one,
        replace(one, name="other"),
        replace(one, old="no such text", new="x"),
        replace(one, name="a", file="nowhere.py", new="y"),
        replace(one, name="b", new=one.old, tests=("tests/test_nothing.py",)),
    ]
    said = mutants.stale(bad)
    assert f"other: the same change as {one.name}" in said
    assert f"{one.name}: twice in the list" in said
    assert any("found 0 times" in line for line in said)
    assert any(line.startswith("a: old text found 0 times in nowhere.py") for line in said)
    assert {"b: changes nothing", "b: no test tests/test_nothing.py"} <= set(said)


def test_changes_of_c_are_behind_their_numbers() -> None:
    one = replace(mutants.read()[0], file="a.c", old="x + 1", new="x")
    other = replace(one, old="y", new="0")
    text = mutants.changed("f(x + 1, y)", [one, other], [3, 7])
    assert text == "f((rg_mutant(3) ? (x) : (x + 1)), (rg_mutant(7) ? (0) : (y)))"


def test_a_copy_has_a_package_of_its_own(tmp_path: Path) -> None:
    mutants.copied(tmp_path)
    for room in ("embedded_sim", "reality", "models", "studies"):
        assert (tmp_path / "realitygap" / room).resolve() == tmp_path / room


@pytest.mark.slow
def test_a_fault_that_no_test_notices_is_told() -> None:
    listed = {one.name: one for one in mutants.read()}
    heard, compiled = listed["unshrunk"], listed["turn-memory-ignored"]
    unheard = replace(heard, name="unheard", tests=("tests/models/gap/test_conditions.py",))
    said = StringIO()
    tried = [heard, compiled, unheard]
    assert mutants.survivors(tried, tried, Console(file=said)) == 1
    lines = {line.split()[3]: line.split()[0] for line in said.getvalue().splitlines()}
    assert lines == {
        "unshrunk": "killed",
        "turn-memory-ignored": "killed",
        "unheard": "SURVIVED",
    }

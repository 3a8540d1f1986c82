"""The rules of naming are printed, and documented as they are."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path

from typer.testing import CliRunner

import realitygap as rg
from realitygap.studies.cli import app
from realitygap.studies.diagnosis.rules import document
from tests.helpers import ROOT

NAMES = [one.name for one in fields(rg.Rules)]


def test_the_documented_rules_are_up_to_date() -> None:
    assert (ROOT / "docs" / "rules.md").read_text(encoding="utf-8") == document(rg.Rules()), (
        "run: realitygap rules --out docs/rules.md --force"
    )


def test_the_command_prints_every_rule() -> None:
    printed = CliRunner().invoke(app, ["rules"])
    assert printed.exit_code == 0
    assert [line.split()[0] for line in printed.output.splitlines() if line[2:3].strip()][
        -len(NAMES) :
    ] == NAMES


def test_as_json_they_are_a_list_of_objects() -> None:
    printed = CliRunner().invoke(app, ["rules", "--json"])
    said = json.loads(printed.output)
    assert [one["rule"] for one in said] == NAMES
    assert set(said[0]) == {"rule", "value", "unit", "reason", "origin"}


def test_a_file_that_is_no_document_of_rules_is_not_replaced(tmp_path: Path) -> None:
    mine = tmp_path / "mine.md"
    mine.write_text("# Mine\n")
    printed = CliRunner().invoke(app, ["rules", "--out", str(mine), "--force"])
    assert printed.exit_code != 0
    assert mine.read_text() == "# Mine\n"


def test_the_table_of_other_rules_has_their_values() -> None:
    table = rg.rules(rg.Rules(price=8.0)).set_index("rule")
    assert table.loc["price", "value"] == 8.0

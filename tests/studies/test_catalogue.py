"""The catalogue is complete, printed, and documented as it is."""

from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner

from realitygap.reality.effects import catalogue
from realitygap.studies.cli import app
from realitygap.studies.hidden.catalogue import KINDS, document, entries, key_text

DOCUMENT = Path(__file__).parents[2] / "docs" / "effects.md"


def test_the_documented_catalogue_is_up_to_date() -> None:
    assert DOCUMENT.read_text(encoding="utf-8") == document(), (
        "run: realitygap effects --out docs/effects.md --force"
    )


def test_every_effect_is_listed_once() -> None:
    listed = [entry.effect.name for kind in KINDS for entry in entries(kind)]
    assert sorted(listed) == sorted(catalogue())


def test_every_motion_effect_has_a_cause_of_the_same_name() -> None:
    assert [entry.effect.name for entry in entries("motion") if not entry.cause] == []


def test_keys_tell_unit_bounds_null_and_default() -> None:
    parameters = catalogue()["tracker_offset"].parameters
    assert key_text("x", parameters["x"]) == "x: [-0.1, 0.1] m (null 0, default 0.0)"
    wheel = catalogue()["motor_saturation"].parameters["wheel"]
    assert key_text("wheel", wheel) == "wheel: left | right | both (default both)"


def test_the_command_prints_the_catalogue() -> None:
    printed = CliRunner().invoke(app, ["effects"])
    assert printed.exit_code == 0
    assert "command_latency" in printed.output
    assert "seconds: [0, 2] s (null 0)" in printed.output


def test_quiet_prints_the_names_alone() -> None:
    printed = CliRunner().invoke(app, ["effects", "--quiet"])
    assert printed.exit_code == 0
    assert sorted(printed.output.split()) == sorted(catalogue())

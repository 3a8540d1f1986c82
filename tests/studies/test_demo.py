"""The demo: what it hides and keeps to itself, and the whole story in short."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from realitygap.models.belief.modelfile import read_model_file
from realitygap.reality.effects import parse_effects
from realitygap.studies.demo.chapters import CHAPTERS, tell
from realitygap.studies.demo.hide import MENU_OF_THE_DEMO, draw, run_seed, seal, unseal
from realitygap.studies.demo.report import write_report
from realitygap.studies.demo.story import Size, as_json
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.provenance import write_json
from realitygap.studies.run.experiment import RunConfig
from tests.browser import CHROMIUM, check_fits

SEEDS = range(200)


def test_everything_that_can_be_drawn_is_far_above_what_must_be_named() -> None:
    drawn = [draw(seed) for seed in SEEDS]
    assert {one.hidden.name for one in drawn} == set(MENU_OF_THE_DEMO)
    for one in drawn:
        entry = MENU[one.hidden.name]
        assert one.hidden.size >= 2.0 * max(entry.bar, entry.swarm_bar)
        (hidden,) = parse_effects(one.effects, 10)
        assert hidden.values == one.hidden.values
        assert hidden.robots == ()


def test_what_is_hidden_follows_from_the_seed_alone() -> None:
    assert [draw(seed) for seed in range(10)] == [draw(seed) for seed in range(10)]
    assert len({draw(seed).hidden.spec for seed in SEEDS}) > 150  # values are rounded
    assert len({run_seed(3, index) for index in range(50)}) == 50


def test_a_seal_that_was_broken_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "sealed.json"
    digest = seal(draw(1), RunConfig(), path)
    assert unseal(path, digest)["spec"] == draw(1).hidden.spec
    path.write_text(path.read_text(encoding="utf-8") + " ", encoding="utf-8")
    with pytest.raises(RuntimeError, match="changed since it was sealed"):
        unseal(path, digest)


def test_the_whole_story_in_short(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """A bright lamp that nobody told the robots of: named, believed, and worth food."""
    size = Size(
        minutes=1.2,
        pairs=1,
        robots=4,
        trials=4,
        log_minutes=1.2,
        held_out=1,
        held_out_minutes=0.4,
    )
    story = tell(0, size, tmp_path, Workers(2), quiet=False)
    write_json(tmp_path / "demo.json", as_json(story))
    write_report(story, tmp_path)
    said = capfd.readouterr().err
    assert all(f"{k}/8 {name} …" in said for k, name in enumerate(CHAPTERS, start=1))
    content = json.loads((tmp_path / "demo.json").read_text(encoding="utf-8"))
    assert content["hidden"]["spec"] == draw(0).hidden.spec
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for name in ("replay-before.html", "replay-after.html"):
        assert f'<a href="{name}">' in page
        played = (tmp_path / name).read_text(encoding="utf-8")
        assert "The swarm" in played
        lamp = draw(0).hidden.values
        assert f'"hidden": [[{lamp["x"]}, {lamp["y"]}]]' in played
    if CHROMIUM is not None:
        for name in ("report.html", "replay-before.html"):
            check_fits(tmp_path / name, tmp_path / name.removesuffix(".html"))
    assert not list(tmp_path.rglob("truth.json"))  # nothing but the seal holds what was hidden
    found = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
    entries = {one["name"]: one["value"] for one in found["log"]["preflight"]}
    assert entries["recorded_like_reference"] is True  # cut, the log still says what recorded it
    assert content["diagnosis"]["named"]  # of so short a log more may be named beside it
    assert "hidden was second_lamp: rightly named" in story.verdict
    causes = content["diagnosis"]["causes"]
    lamp = next(cause for cause in causes if cause["name"] == "second_lamp")
    intensity = lamp["parameters"]["intensity"]
    assert intensity["value"] == pytest.approx(draw(0).hidden.values["intensity"], rel=0.3)
    extended = read_model_file(tmp_path / "diagnosis" / "extended.toml")
    assert extended.extension is not None
    named = [cause.name for cause in extended.extension.causes]
    assert named == [cause["name"] for cause in causes]
    light = next(one for one in content["prediction"] if one["channel"] == "light")
    assert light["extended"]["value"] < 0.5 * light["before"]["value"]
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert page.index("data:image/png") < page.index("What was hidden")  # a picture comes first
    assert page.count("data:image/png;base64,") == 3

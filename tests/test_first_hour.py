"""The way of `docs/first-hour.md`, gone: from bags of a robot never seen to a verified gain."""

from __future__ import annotations

import html
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from realitygap import Model, diagnose
from tests.helpers import ROOT
from tests.models.bags import commands, poses, together, write_bag
from tests.own_robot import own_log

pytest.importorskip("rosbags", reason="the extra [ros] is not installed")

SMALLER, LAG = 0.97, 0.06
"""Hidden: the right wheel's radius over the left one's; s, of the motors."""
NUMBER = r"\d+\.?\d*"


def blocks(language: str) -> list[str]:
    text = (ROOT / "docs" / "first-hour.md").read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def test_six_commands_lead_from_a_bag_to_a_repaired_model_and_its_gain(tmp_path: Path) -> None:
    log = own_log(240.0, seed=4, larger=SMALLER, lag=LAG)
    for name, part in (("morning", log["t"] < 150.0), ("afternoon", log["t"] >= 150.0)):
        messages = together(commands(log[part]), poses(log[part], "/vrpn/crawler/pose"))
        write_bag(tmp_path / name, "ros2", messages)
    lines = "".join(blocks("sh")).splitlines()
    assert len(lines) <= 6
    here = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    said = ""
    for line in lines:
        done = subprocess.run(
            ["bash", "-c", line],
            cwd=tmp_path,
            env={**os.environ, "PATH": here, "COLUMNS": "1000"},
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert done.returncode == 0, f"{line}\n{done.stderr}"
        said += done.stdout

    found = json.loads((tmp_path / "named" / "diagnosis.json").read_text())
    assert found["verdict"] == "named"
    values = {one["name"]: one["parameters"] for one in found["causes"]}
    assert values.keys() == {"wheel_radius_mismatch", "motor_lag"}
    ratio, lag = values["wheel_radius_mismatch"]["ratio"], values["motor_lag"]["time_constant"]
    assert ratio["low"] < SMALLER < ratio["high"] < 1.0
    assert lag["low"] < LAG < lag["high"]
    repaired = Model.load(tmp_path / "named" / "extended.toml")
    assert set(repaired.causes["cause"]) == values.keys()

    errors = json.loads((tmp_path / "gained" / "gain.json").read_text())["errors"]
    motion = [one for one in errors if one["horizon"] in ("1 s", "5 s", "20 s")]
    assert len(motion) == 6
    assert all(one["extended"]["high"] < one["before"]["low"] for one in motion)
    assert 10_000 < (tmp_path / "watch.html").stat().st_size < 5e6

    page = html.unescape(re.sub(r"<[^>]*>", "", (tmp_path / "named" / "report.html").read_text()))
    for told in "".join(blocks("text")).splitlines():
        pattern = re.escape(re.sub(NUMBER, "#", told)).replace(r"\#", f"({NUMBER})")
        seen = re.search(pattern, said) or re.search(pattern, page)
        assert seen, told
        numbers = [float(one) for one in re.findall(NUMBER, told)]
        assert [float(one) for one in seen.groups()] == pytest.approx(numbers, rel=0.05)


def test_a_tracker_that_knows_no_heading_tells_of_the_same_faults() -> None:
    log = own_log(150.0, seed=4, larger=SMALLER, lag=LAG).drop(columns="yaw").assign(robot=0)
    found = diagnose(log, model=ROOT / "docs" / "example" / "robot.toml")
    values = found.causes.set_index("cause")
    assert set(values.index) == {"wheel_radius_mismatch", "motor_lag"}
    for cause, true in (("wheel_radius_mismatch", SMALLER), ("motor_lag", LAG)):
        assert values.loc[cause, "low"] < true < values.loc[cause, "high"]

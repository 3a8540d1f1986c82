"""Where pybullet is missing, logs are imported and judged, and MuJoCo stands for reality."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers import ENVIRONMENT, ROOT

EXAMPLE = ROOT / "docs" / "example"
ROBOT = ("--model", EXAMPLE / "robot.toml")
MAPPED = ("--map", EXAMPLE / "map.toml", *ROBOT)
BLOCKED = """
import sys
sys.modules["pybullet"] = None
from realitygap.studies.cli import main
main()
"""
"""A process in which `import pybullet` raises ImportError, and nothing finds it."""


def without(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", BLOCKED, *map(str, words)],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two logs of one robot and the diagnosis of the first, all made without pybullet."""
    room = tmp_path_factory.mktemp("without")
    for name in ("log", "later"):
        done = without(
            "import", "csv", EXAMPLE / f"{name}.csv", *MAPPED, "--out", room / f"{name}.csv"
        )
        assert done.returncode == 0, done.stderr
    done = without("diagnose", room / "log.csv", *ROBOT, "--out", room / "found")
    assert done.returncode == 0, done.stderr
    return room


def test_a_diagnosis_says_that_there_was_no_pybullet(room: Path) -> None:
    found = json.loads((room / "found" / "diagnosis.json").read_text())
    assert found["verdict"]
    assert "pybullet" not in found["versions"]
    assert "numpy" in found["versions"]


@pytest.mark.parametrize(
    "words",
    [
        ("gap", "ROOM/log.csv", *ROBOT, "--out", "OUT"),
        ("replay", "ROOM/log.csv", *ROBOT, "--out", "OUT.html"),
        (
            "gain",
            "--log",
            "ROOM/later.csv",
            "--extended",
            "ROOM/found/extended.toml",
            "--out",
            "OUT",
        ),
        ("reference", "ROOM/log.csv", "ROOM/later.csv", *ROBOT, "--out", "OUT.json"),
        ("capture", "--out", "OUT.npz"),
        ("effects",),
        ("rules",),
        ("model", "new", "--wheel-radius", "0.03", "--axle", "0.2"),
    ],
    ids=lambda words: words[0],
)
def test_what_concerns_logs_works(words: tuple[object, ...], room: Path, tmp_path: Path) -> None:
    places = {"ROOM": str(room), "OUT": str(tmp_path / "out")}
    given = [str(word) for word in words]
    for name, place in places.items():
        given = [word.replace(name, place) for word in given]
    done = without(*given)
    assert done.returncode == 0, done.stderr


def test_a_swarm_forages_in_mujoco(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    words = ("run", "--minutes", "0.05", "--robots", "2", "--engine", "mujoco")
    done = without(*words, "--out", tmp_path / "run")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ("run",),
        ("demo",),
        ("blind",),
        ("study", "paper"),
        ("study", "transfer"),
        ("reference", "--runs", "1"),
        (
            "gain",
            "--log",
            "x",
            "--extended",
            "y",
            "--effect",
            "motor_lag:time_constant=0.1,robot=1",
        ),
        ("measure", "bench"),
    ],
    ids=" ".join,
)
def test_what_needs_it_says_so_in_one_line_and_writes_nothing(
    words: tuple[str, ...], tmp_path: Path
) -> None:
    done = without(*words, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "realitygap: --engine: got 'pybullet', expected pybullet to be installed, which Python "
        "3.11 has and later ones have not; or --engine mujoco, with the extra [mujoco]"
    ]
    assert list(tmp_path.iterdir()) == []


def test_nothing_imports_it_before_a_world_is_made() -> None:
    code = "import sys; import realitygap.studies.cli, realitygap.studies.run.experiment\n"
    code += "import realitygap as rg; [getattr(rg, name) for name in rg.__all__]\n"
    code += "print(sorted({'pybullet', 'mujoco'} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code], env=ENVIRONMENT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"

"""What is installed is one package, under one name."""

from __future__ import annotations

import email
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

from tests.helpers import ROOT

ROOMS = ("embedded_sim", "reality", "models", "studies")


def python(code: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=cwd,
        env={"PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def test_nothing_but_realitygap_can_be_imported(tmp_path: Path) -> None:
    code = f"import importlib.util as u; print([n for n in {ROOMS} if u.find_spec(n)])"
    assert python(code, tmp_path).stdout.strip() == "[]"
    code = f"import realitygap; print(*(u.__name__ for u in map(__import__, {ROOMS!r})))"
    assert "ModuleNotFoundError" in python(code, tmp_path).stderr


@pytest.mark.parametrize("room", ROOMS)
def test_a_users_folder_of_a_rooms_name_shadows_nothing(tmp_path: Path, room: str) -> None:
    (tmp_path / room).mkdir()
    (tmp_path / room / "__init__.py").write_text("raise SystemExit('the wrong one')\n")
    code = f"import realitygap.{room} as ours; print(ours.__name__)"
    assert python(code, tmp_path).stdout.strip() == f"realitygap.{room}"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a release is: an sdist of the tracked files, and the wheel made from that sdist."""
    room = tmp_path_factory.mktemp("release")
    listed = ["git", "ls-files", "-co", "--exclude-standard", "-z"]
    names = subprocess.run(listed, cwd=ROOT, capture_output=True, check=True).stdout
    tree = room / "tree"
    for name in filter(None, names.decode().split("\0")):
        if (ROOT / name).exists():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name, follow_symlinks=False)
    run([sys.executable, "setup.py", "-q", "sdist", "--dist-dir", str(room)], tree)
    (sdist,) = room.glob("*.tar.gz")
    wheel = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation"]
    run([*wheel, "--no-index", "-w", str(room), str(sdist)], room)
    return room


def run(words: list[str], cwd: Path) -> str:
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_a_wheel_serves_every_python_from_3_11_on_and_is_complete(built: Path) -> None:
    (wheel,) = built.glob("*.whl")
    assert "-cp311-abi3-" in wheel.name
    with zipfile.ZipFile(wheel) as packed:
        names = {*packed.namelist()}
        (place,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        said = email.message_from_bytes(packed.read(place))
    assert {"realitygap/py.typed", "realitygap/embedded_sim/_core.abi3.so"} <= names
    shipped = (".py", ".toml", ".npz", ".json", ".j2", ".parquet")
    for room in ROOMS:
        for path in (ROOT / room).rglob("*"):
            if path.suffix in shipped and "__pycache__" not in path.parts:
                assert f"realitygap/{path.relative_to(ROOT).as_posix()}" in names
    assert said["Requires-Python"] == ">=3.11"
    assert said["Description-Content-Type"] == "text/markdown"
    assert str(said.get_payload()).strip() == (ROOT / "README.md").read_text("utf-8").strip()
    assert "Typing :: Typed" in said.get_all("Classifier", [])
    needed = said.get_all("Requires-Dist", [])
    assert 'pybullet==3.2.7; python_version < "3.12"' in needed


@pytest.mark.slow
def test_a_wheel_in_a_fresh_environment_diagnoses_a_log(built: Path, tmp_path: Path) -> None:
    """Its dependencies are lent by this environment: a test asks no network."""
    venv.create(tmp_path / "fresh", with_pip=False)
    fresh = tmp_path / "fresh" / "bin" / "python"
    site = "import sysconfig; print(sysconfig.get_path('purelib'))"
    place = Path(run([str(fresh), "-c", site], tmp_path).strip())
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(place)
    (place / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n")  # not its own .pth files
    where = run([str(fresh), "-c", "import realitygap; print(realitygap.__file__)"], tmp_path)
    assert Path(where.strip()).is_relative_to(place)
    example = ROOT / "docs" / "example"
    words = [str(fresh), "-m", "realitygap.studies.command"]
    mapped = ["--map", str(example / "map.toml"), "--model", str(example / "robot.toml")]
    run([*words, "import", "csv", str(example / "log.csv"), *mapped, "--out", "log.csv"], tmp_path)
    run([*words, "diagnose", "log.csv", *mapped[2:], "--out", "found"], tmp_path)
    assert (tmp_path / "found" / "report.html").exists()

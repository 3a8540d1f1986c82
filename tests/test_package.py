"""What is installed is one package, under one name."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

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

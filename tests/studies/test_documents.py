"""What the documents tell a reader to do, done."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from tests.helpers import ROOT, realitygap


def blocks(document: str, language: str) -> list[str]:
    text = (ROOT / document).read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def test_every_realitygap_command_of_the_readme_works(tmp_path: Path) -> None:
    """In order, in a directory of its own, with the paths the README uses."""
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    ran = 0
    for line in "\n".join(blocks("README.md", "sh")).splitlines():
        words = shlex.split(line, comments=True)
        if words and words[0].endswith("realitygap"):
            done = realitygap(*words[1:], cwd=tmp_path)
            assert done.returncode == 0, f"{line}\n{done.stderr}"
            ran += 1
    assert ran >= 5


def test_the_readmes_python_works_on_what_its_commands_wrote(tmp_path: Path) -> None:
    done = realitygap(
        "run", "--minutes", "1.1", "--robots", "2", "--out", tmp_path / "out" / "run", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    code, _ = blocks("README.md", "python")
    code = code.replace('"out/run/', f'"{tmp_path}/out/run/')
    exec(compile(code, "README.md", "exec"), {})


def snippets(document: str) -> None:
    """Execute a document's Python, block by block, as one reader would type it."""
    typed: dict[str, object] = {}
    for code in blocks(document, "python"):
        exec(compile(code, document, "exec"), typed)


@pytest.fixture
def beside_docs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_readmes_lines_for_a_notebook_work(
    beside_docs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, code = blocks("README.md", "python")
    exec(compile(code, "README.md", "exec"), {})
    said = capsys.readouterr().out
    assert "Diagnosis: " in said
    assert "wheel_radius_mismatch" in said
    assert "Gain\n" in said
    assert (beside_docs / "out" / "mine-notebook" / "report.html").is_file()


def test_every_snippet_of_the_door_works(
    beside_docs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    snippets("docs/api.md")
    said = capsys.readouterr().out
    assert "Diagnosis: named" in said
    assert "did you mean epuck" in said
    before, after = map(float, re.findall(r"^(\S+) rad after 1 s$", said, re.MULTILINE))
    assert after < 0.5 * before
    assert (beside_docs / "out" / "diagnosis" / "extended.toml").is_file()


@pytest.mark.parametrize("target", ["demo", "test", "lint", "asan", "bench"])
def test_every_make_target_of_the_readme_exists(target: str) -> None:
    assert f"make {target}" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)

"""What the documents tell a reader to do, done."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from tests.helpers import ROOT, realitygap
from tests.own_robot import example


def blocks(document: str, language: str) -> list[str]:
    text = (ROOT / document).read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


@pytest.mark.parametrize(
    ("document", "number"),
    [
        ("README.md", 5),
        pytest.param("docs/experiment.md", 5, marks=pytest.mark.slow),
        pytest.param("docs/replay.md", 2, marks=pytest.mark.slow),
    ],
)
def test_every_realitygap_command_works(tmp_path: Path, document: str, number: int) -> None:
    """In order, in a directory of its own, with the paths that the document uses."""
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    ran = 0
    for line in "\n".join(blocks(document, "sh")).replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if words and words[0].endswith("realitygap"):
            done = realitygap(*words[1:], cwd=tmp_path)
            assert done.returncode == 0, f"{line}\n{done.stderr}"
            ran += 1
    assert ran >= number


def test_the_readme_is_short_and_begins_with_a_picture_that_moves() -> None:
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) < 120
    assert lines[0] == "# realitygap"
    first = next(line for line in lines if line.startswith("!["))
    assert lines.index(first) < 10
    film = ROOT / first[first.index("(") + 1 : -1]
    assert film.stat().st_size < 1.5e6
    with Image.open(film) as pictures:
        assert getattr(pictures, "n_frames", 1) >= 100


def test_the_example_is_what_the_robot_of_the_tests_drives() -> None:
    for name, table in example().items():
        read = pd.read_csv(ROOT / "docs" / "example" / name)
        assert list(read.columns) == list(table.columns)
        assert np.allclose(read, table, atol=0.011)


def test_the_first_experiments_python_works_on_what_its_commands_wrote(tmp_path: Path) -> None:
    done = realitygap(
        "run", "--minutes", "1.1", "--robots", "2", "--out", tmp_path / "out" / "run", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    (code,) = blocks("docs/experiment.md", "python")
    code = code.replace('"out/run/', f'"{tmp_path}/out/run/')
    exec(compile(code, "docs/experiment.md", "exec"), {})


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
    (code,) = blocks("README.md", "python")
    exec(compile(code, "README.md", "exec"), {})
    said = capsys.readouterr().out
    assert "Diagnosis: named" in said
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


@pytest.mark.parametrize("document", ["README.md", "docs/installing.md"])
def test_every_make_target_that_is_told_of_exists(document: str) -> None:
    text = (ROOT / document).read_text(encoding="utf-8")
    told = set(re.findall(r"^make ([a-z-]+)|`make ([a-z-]+)`", text, re.MULTILINE))
    targets = {one or other for one, other in told}
    assert {"demo", "test", "site"} <= targets
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


DOCUMENTS = sorted(
    str(path.relative_to(ROOT)) for path in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
)


def anchors(path: Path) -> set[str]:
    """What a link may point to within a document."""
    heads = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("document", DOCUMENTS)
def test_no_link_between_documents_is_broken(document: str) -> None:
    path = ROOT / document
    text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        there = path if not file else path.parent / file
        assert there.exists(), target
        assert not anchor or anchor in anchors(there), target


def test_every_command_has_its_line_in_the_table_of_commands() -> None:
    table = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    listed = realitygap("--help").stdout
    names = re.findall(r"^│ ([a-z]+) ", listed, re.MULTILINE)
    assert len(names) >= 10
    for name in names:
        assert f"`{name}" in table, name

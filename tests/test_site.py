"""The documents as a site."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers import ROOT


@pytest.mark.slow
@pytest.mark.skipif(
    importlib.util.find_spec("mkdocs") is None, reason="mkdocs is not installed: the extra [docs]"
)
def test_the_site_builds_strictly_and_fetches_nothing(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    done = subprocess.run(
        words,
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    commands = (tmp_path / "commands" / "index.html").read_text(encoding="utf-8")
    assert "--exit-code" in commands
    python = (tmp_path / "python" / "index.html").read_text(encoding="utf-8")
    assert 'id="realitygap.DiagnosisResult.causes"' in python
    for page in tmp_path.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(
            r'(<script[^>]*src|<link[^>]*stylesheet[^>]*href|<img[^>]*src)="?http', text
        )


def test_the_reference_has_every_name_of_the_door() -> None:
    import realitygap as rg

    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^::: realitygap\.(?:studies\.)?(\w+)$", text, re.MULTILINE))
    assert listed == set(rg.__all__)

"""The notebooks: each runs from its first cell to its last."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from typing import Any

import pytest

from tests.helpers import ROOT

NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
MISSING = [name for name in ("nbclient", "ipykernel") if importlib.util.find_spec(name) is None]


def cells(path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return found


def test_there_are_three_notebooks_without_outputs_or_machine() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["hide-and-find", "my-robot", "swarm"]
    for path in NOTEBOOKS:
        code = [cell for cell in cells(path) if cell["cell_type"] == "code"]
        assert len(code) >= 5
        assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
        assert "/tmp/" not in path.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of the machinery that runs notebooks
@pytest.mark.skipif(bool(MISSING), reason=f"not installed: {MISSING}, the extra [docs]")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_draws(path: Path) -> None:
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    room = {"metadata": {"path": str(ROOT)}}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources=room).execute()
    shown = [out for c in notebook.cells if c.cell_type == "code" for out in c.outputs]
    kinds = [kind for out in shown for kind in out.get("data", {})]
    assert kinds.count("image/png") >= 1
    assert kinds.count("text/html") >= 2

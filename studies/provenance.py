"""Where a result comes from: versions of what computed it, and JSON written one way."""

from __future__ import annotations

import json
import platform
from importlib.metadata import version
from pathlib import Path


def versions() -> dict[str, str]:
    """Versions of this package, Python and the libraries that results depend on."""
    names = ("reality-gap", "pybullet", "numpy", "scipy", "pandas", "pyarrow")
    return {"python": platform.python_version(), **{name: version(name) for name in names}}


def write_json(path: Path, content: object) -> None:
    """Indented JSON with a final newline; NaN is refused."""
    path.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")

"""A study small enough for a test, and what is the same of two studies that ran differently."""

from __future__ import annotations

import hashlib
from pathlib import Path

from realitygap.studies.paper.conditions import StudyConfig

TINY = StudyConfig(runs=1, minutes=0.1, robots=2, seed=5)
WORDS = ("--runs", "1", "--minutes", "0.1", "--robots", "2", "--seed", "5")
"""The same on the command line."""


def results(out: Path) -> dict[str, str]:
    """Hashes of everything a study's results are, without the notes on how long it took."""
    return {
        str(path.relative_to(out)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(out.rglob("*"))
        if path.suffix in (".parquet", ".csv") or path.name == "truth.json"
    }

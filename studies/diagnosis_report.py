"""The report of a diagnosis."""

from __future__ import annotations

from pathlib import Path

from models.identify.diagnose import Examination
from studies.diagnosis_words import verdict_sentence


def write_report(examined: Examination, path: Path, *, command: str) -> None:
    """Write one self-contained page."""
    path.write_text(f"<p>{verdict_sentence(examined.diagnosis)}</p>", encoding="utf-8")

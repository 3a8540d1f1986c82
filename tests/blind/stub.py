"""A stand-in for the diagnosis: it reads the log, and only knows covered light sensors.

Without that cause it says that something is unexplained.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pandas as pd

DARK = 4080.0
"""counts: a covered sensor sees not even the room's light."""


def main(log: str, out: str, without: tuple[str, ...]) -> None:
    here = Path.cwd()
    diagnosis = said(here, log, without)
    (here / out).mkdir()
    (here / out / "diagnosis.json").write_text(json.dumps(diagnosis))


def ask_stub(given: Path, without: tuple[str, ...]) -> tuple[dict[str, Any] | None, str | None]:
    """The same without a process of its own, as the battery asks."""
    try:
        return said(given, "samples.parquet", without), None
    except Exception as error:
        return None, f"{type(error).__name__}: {error}"


def said(here: Path, log: str, without: tuple[str, ...]) -> dict[str, Any]:
    assert [path.name for path in here.iterdir()] == [log], "something beside the log"
    samples = pd.read_parquet(here / log)
    if "ls0" not in samples:
        raise ValueError("no light sensors")
    medians = samples.groupby("robot")[[f"ls{i}" for i in range(8)]].median()
    causes = [
        {
            "name": "ls_dead_sensor",
            "robots": [int(robot)],
            "parameters": {"sensor": {"value": sensor, "low": sensor, "high": sensor, "unit": ""}},
            "evidence": {"held_out_gain": 1.0, "score": 99.0},
        }
        for robot, row in medians.iterrows()
        for sensor, value in enumerate(row)
        if value > DARK
    ]
    left = []
    if "ls_dead_sensor" in without:
        left = [
            {"channel": "light", "where": "", "quantity": "sensor", "robots": cause["robots"]}
            for cause in causes
        ]
        causes = []
    verdict = "unexplained" if left else "named" if causes else "nothing_wrong"
    found = {"schema": 1, "verdict": verdict, "causes": causes, "unexplained": left}
    return found | {"detectable": {}, "log": {"preflight": []}}


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[3], tuple(sys.argv[5::2]))

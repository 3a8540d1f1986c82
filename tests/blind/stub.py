"""A stand-in for the diagnosis: it reads the log, and only knows covered light sensors.

Without that cause it says that something is unexplained.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pandas as pd

DARK = 4080.0
"""counts: a covered sensor sees not even the room's light."""


def main(log: str, out: str, without: tuple[str, ...]) -> None:
    here = Path.cwd()
    assert [path.name for path in here.iterdir()] == [log], "something beside the log"
    samples = pd.read_parquet(log)
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
    diagnosis = {"schema": 1, "verdict": verdict, "causes": causes, "unexplained": left}
    (here / out).mkdir()
    (here / out / "diagnosis.json").write_text(json.dumps(diagnosis))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[3], tuple(sys.argv[5::2]))

"""The gain in food, out of a finished study of transfer, beside the gain in prediction."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.embedded_sim.errors import InputError
from realitygap.models.log.opened import json_values, parsing

FILE = "transfer.json"
SCHEMA = 1
METRIC = "food"


def read_transfer(study: Path) -> dict[str, Any]:
    """The entry `transfer` of `gain.json`: the alterations of a study, compared.

    Raises:
        InputError: `study` is no directory of a finished study of transfer.
    """
    path = study / FILE
    expected = f"a directory of `realitygap study transfer` with its {FILE}"
    content = json_values(path, expected, field="--transfer")
    with parsing("--transfer", expected):
        if content["schema"] != SCHEMA:
            raise InputError(f"{path}: schema", content["schema"], str(SCHEMA))
        found = {
            "configuration": content["configuration"],
            "alterations": list(content["alterations"]),
        }
        food_table(found)  # has what is told of it
        return found


def food_table(transfer: dict[str, Any]) -> pd.DataFrame:
    """A row per alteration and pair of models."""
    rows = [
        {
            "reality": one["label"],
            "compared": f"{found['first']} − {found['second']}",
            "food": found["mean_first"],
            "against": found["mean_second"],
            "difference": found["difference"],
            "low": found["low"],
            "high": found["high"],
            "verdict": found["verdict"] or None,
        }
        for one in transfer["alterations"]
        for found in one["comparisons"]
        if found["metric"] == METRIC
    ]
    return pd.DataFrame(rows)


def food_lines(transfer: dict[str, Any]) -> list[str]:
    """In words: where the extended model collects more than the minimal one, and where less."""
    table = food_table(transfer)
    if table.empty:
        return []
    own = table[table["compared"] == "extended − minimal"]
    told = [
        f"{len(own[own['verdict'] == verdict])} {verdict}"
        for verdict in ("more", "not shown", "less")
    ]
    return [
        f"Food with the extended model against the minimal one, in {len(own)} altered realities: "
        f"{', '.join(told)}."
    ]

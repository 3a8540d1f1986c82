"""The gain in food, out of a finished study of transfer, beside the gain in prediction."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd

from embedded_sim.errors import InputError

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
    if not path.is_file():
        raise InputError("--transfer", study, expected)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["schema"] != SCHEMA:
            raise InputError(f"{path}: schema", content["schema"], str(SCHEMA))
        return {
            "configuration": content["configuration"],
            "alterations": list(content["alterations"]),
        }
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("--transfer", path, expected) from None


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

"""The matrix from beginning to end: the logs that are missing, then the cells and the page."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.reality.engine import DEFAULT
from realitygap.reality.rays import DEFAULT_RAYS
from realitygap.studies.blind.conditions.diagnosed import diagnose_cell
from realitygap.studies.blind.conditions.matrix import CONDITIONS, MatrixConfig, plan
from realitygap.studies.blind.conditions.page import write_pages
from realitygap.studies.blind.conditions.scores import (
    cells_of,
    log_result,
    logs_table,
    summary,
)
from realitygap.studies.blind.directory import BlindDirectory
from realitygap.studies.blind.examiner import ask
from realitygap.studies.blind.missing import do_missing
from realitygap.studies.blind.record import Diagnosed
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.provenance import commit, versions, write_json
from realitygap.studies.plumbing.typed import option, typed

SCHEMA = 1


def run_matrix(
    config: MatrixConfig,
    out: Path,
    workers: Workers,
    *,
    quiet: bool = False,
    diagnosed: Diagnosed | None = None,
) -> dict[str, Any]:
    """Run or resume a matrix in `out`; returns the content of `conditions.json`.

    Args:
        config: Which conditions, how many logs.
        out: Its directory; conditions and logs that are there stay as they are.
        workers: Where logs are recorded and diagnosed.
        quiet: Say nothing.
        diagnosed: What diagnoses the log in a directory; importable; `ask` if absent.

    Raises:
        InputError: `out` cannot be used.
        TrialsFailed: logs could not be recorded; a failed diagnosis is a result.
        WorkersLost: workers keep dying.
    """
    planned = plan(config)
    with BlindDirectory(out, config, planned).held() as directory:
        who = diagnosed or partial(ask, reference=config.reference)
        do_missing(directory, workers, quiet, who, diagnose_cell)
        answers = [answer for _, answer in directory.answers()]
        logs = logs_table(map(log_result, planned, answers))
        cells = cells_of(logs)
        content = {
            "schema": SCHEMA,
            "config": config.model_dump(mode="json"),
            "command": _command(config),
            "commit": commit(),
            "versions": versions(),
            "summary": summary(cells),
            "cells": cells,
        }
        with whole_file(out / "conditions.json", force=True) as part:
            write_json(part, content)
        for name, table in (("cells.csv", pd.DataFrame(cells)), ("logs.csv", logs)):
            with whole_file(out / name, force=True) as part:
                table.to_csv(part, index=False)
        write_pages(out, content, logs)
    return content


def _command(config: MatrixConfig) -> str:
    """What a user would type."""
    only = () if len(config.conditions) == len(CONDITIONS) else config.conditions
    words: list[object] = ["realitygap", "blind", "--conditions", "--trials", config.trials]
    words += ["--seed", config.seed, *option("--only", only)]
    words += ["--engine", config.engine] if config.engine != DEFAULT else []
    words += ["--reference", config.reference] if config.reference else []
    return typed(*words, *(["--rays", config.rays] if config.rays != DEFAULT_RAYS else []))

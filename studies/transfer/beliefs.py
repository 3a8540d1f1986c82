"""The models on board: minimal, extended by a diagnosis that sees the log alone, and oracle."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from realitygap.reality.effects import parse_effects
from realitygap.studies.blind.examiner import LOG
from realitygap.studies.blind.record import COMMAND, diagnose, record
from realitygap.studies.hidden.shares import write_oracle
from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.altered import Files, read_files
from realitygap.studies.run.experiment import RunConfig
from realitygap.studies.transfer.alterations import Alteration


@dataclass(frozen=True)
class Preparation:
    """A reality to record and diagnose."""

    alteration: Alteration
    config: RunConfig
    command: tuple[str, ...] = COMMAND


def record_and_diagnose(task: Preparation) -> Files:
    """Record a log in the altered reality and let a process diagnose it that has nothing else.

    Returns:
        What the diagnosis wrote, by name. Executed by a worker.

    Raises:
        RuntimeError: the diagnosis failed.
    """
    with scratch() as given:
        record(task.config, task.alteration.effects, given / LOG)
        _, error = diagnose(given, command=task.command)
        if error is not None:
            raise RuntimeError(f"the diagnosis of {task.alteration.name}: {error}")
        return read_files(given / "diagnosis")


def given_model(extended: str) -> Files:
    """A given extended model and its sensor tables.

    Raises:
        InputError: it is no model file.
    """
    return _written(Model.load(extended).keep)


def oracle_model(alteration: Alteration, robots: int) -> Files:
    """The model with the true parameters, which only the study itself can know."""
    hidden = parse_effects(alteration.effects, robots)
    return _written(lambda part: write_oracle(hidden, part))


def _written(write: Callable[[Path], None]) -> Files:
    """What is written into a directory."""
    with scratch() as room:
        write(room)
        return read_files(room)


def diagnosis_of(folder: Path) -> dict[str, Any] | None:
    """The `diagnosis.json` beside an extended model; None: the model was given."""
    path = folder / "diagnosis.json"
    if not path.is_file():
        return None
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found

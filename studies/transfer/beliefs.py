"""The models on board: minimal, extended by a diagnosis that sees the log alone, and oracle."""

from __future__ import annotations

import json
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from embedded_sim.errors import InputError
from models.modelfile import read_model_file
from reality.effects import parse_effects
from studies.altered import MODEL, Files, read_files
from studies.blind.examiner import LOG
from studies.blind.record import COMMAND, diagnose
from studies.experiment import RunConfig, simulate
from studies.oracle import write_oracle
from studies.output import whole_directory
from studies.transfer.alterations import Alteration


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
    with tempfile.TemporaryDirectory(prefix="realitygap-") as scratch:
        run, given = Path(scratch) / "run", Path(scratch) / "given"
        run.mkdir()
        given.mkdir()
        simulate(task.config, task.alteration.effects, run)
        shutil.move(run / LOG, given / LOG)
        shutil.rmtree(run)
        _, error = diagnose(given, command=task.command)
        if error is not None:
            raise RuntimeError(f"the diagnosis of {task.alteration.name}: {error}")
        return read_files(given / "diagnosis")


def keep_given(extended: str, folder: Path) -> None:
    """Copy a given extended model and its sensor tables.

    Raises:
        InputError: it is no model file.
    """
    source = Path(extended)
    model = read_model_file(source)
    if not source.is_file() or model.sensors is None:
        raise InputError("--extended", extended, "a model file with [sensors]")
    with whole_directory(folder) as part:
        tables = source.parent / model.sensors.tables
        (part / model.sensors.tables).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(tables, part / model.sensors.tables)
        shutil.copyfile(source, part / MODEL)


def keep_oracle(alteration: Alteration, robots: int, folder: Path) -> None:
    """The model with the true parameters, which only the study itself can know."""
    with whole_directory(folder) as part:
        write_oracle(parse_effects(alteration.effects, robots), part)


def diagnosis_of(folder: Path) -> dict[str, Any] | None:
    """The `diagnosis.json` beside an extended model; None: the model was given."""
    path = folder / "diagnosis.json"
    if not path.is_file():
        return None
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found

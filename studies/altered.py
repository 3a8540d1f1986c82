"""Runs in altered reality as tasks for workers: what comes back are the run's files by name."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from realitygap.studies.experiment import RunConfig, simulate
from realitygap.studies.output import whole_directory
from realitygap.studies.provenance import write_json
from realitygap.studies.rooms import scratch

Files = Mapping[str, bytes]
NOTES = "run.json"
MODEL = "extended.toml"
"""Of a directory with an extended model and its sensor tables."""


@dataclass(frozen=True)
class AlteredRun:
    """A run, what is hidden in it, and the model on board."""

    config: RunConfig
    effects: tuple[str, ...]
    model: Files | None = None
    """An extended model with its tables; None: as the configuration says."""


def run_altered(task: AlteredRun) -> dict[str, bytes]:
    """Simulate; the run's files by name. Executed by a worker, which needs no disk in common."""
    with scratch() as room:
        out, model = room / "run", room / "model"
        out.mkdir()
        config = task.config
        if task.model is not None:
            keep(task.model, model)
            config = config.model_copy(update={"model": str(model / MODEL)})
        simulate(config, task.effects, out)
        if task.model is not None:  # not the temporary path, which differs from run to run
            notes = json.loads((out / NOTES).read_text(encoding="utf-8"))
            notes["config"]["model"] = MODEL
            for one in notes["inputs"]:
                one["file"] = Path(one["file"]).name
            write_json(out / NOTES, notes)
        return dict(read_files(out))


def read_files(folder: Path) -> Files:
    """A directory's files by name."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def keep(files: Files, folder: Path) -> None:
    """Write a directory of files, whole or not at all."""
    with whole_directory(folder) as part:
        for name, content in files.items():
            (part / name).write_bytes(content)

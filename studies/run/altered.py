"""Runs in altered reality as tasks for workers: what comes back are the run's files by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from realitygap.studies.inputs.model import Model
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.run.experiment import RunConfig, simulate

Files = Mapping[str, bytes]
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
        config, believed = task.config, None
        if task.model is not None:
            keep(task.model, model)
            # without the temporary path, which differs from run to run
            believed = replace(Model.load(model / MODEL), path=None, given=None)
            config = config.model_copy(update={"model": MODEL})
        simulate(config, task.effects, out, model=believed)
        return dict(read_files(out))


def read_files(folder: Path) -> Files:
    """A directory's files by name."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def keep(files: Files, folder: Path) -> None:
    """Write a directory of files, whole or not at all."""
    with whole_directory(folder) as part:
        for name, content in files.items():
            (part / name).write_bytes(content)

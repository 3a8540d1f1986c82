"""The study from beginning to end: models, runs, comparison, report."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.execution import RunsFailed, execute
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.manifest import Pieces, made
from realitygap.studies.plumbing.progress import Stages
from realitygap.studies.run.altered import AlteredRun, Files, run_altered
from realitygap.studies.transfer import beliefs, words
from realitygap.studies.transfer.plan import (
    TransferConfig,
    TransferRun,
    log_config,
    model_origin,
    plan,
)
from realitygap.studies.transfer.report import write_report


@dataclass(frozen=True)
class Work:
    """Runs one run; carries the models, so that a worker needs no disk in common."""

    models: dict[tuple[str, str], Files]
    """By alteration and controller; the minimal model is the shipped one."""

    def __call__(self, run: TransferRun) -> dict[str, bytes]:
        """Simulate; the run's files by name. Executed by a worker."""
        model = self.models.get((run.alteration.name, run.controller))
        return run_altered(AlteredRun(run.config, run.effects, model))


def run_transfer(study: TransferConfig, out: Path, workers: Workers, *, quiet: bool = False) -> str:
    """Run or resume the study in `out` and write `transfer.json`, tables, figures and report.

    Returns:
        What came out, in one line.

    Raises:
        InputError: `out` or a given model cannot be used, or the scheduler does not answer.
        RunsFailed: some runs raised; the others are kept.
        WorkersLost: workers keep dying.
    """
    runs = plan(study)
    with StudyDirectory(out, study, runs).held() as directory:
        models = _prepare(study, out, workers, quiet=quiet)
        execute(directory, workers, Work(models), quiet=quiet)
        return words.outcome(write_report(directory))


def _prepare(
    study: TransferConfig, out: Path, workers: Workers, *, quiet: bool
) -> dict[tuple[str, str], Files]:
    """Every model's files, made where they are missing."""
    pieces = Pieces(out / "models", "model")
    by_name = {
        f"{one.name}.{kind}": (one, kind)
        for one in study.alterations
        for kind in ("extended", "oracle")
    }
    wanted = {name: model_origin(study, *which) or {} for name, which in by_name.items()}
    tasks = []
    with Stages("models", quiet) as shown:
        for name in pieces.missing(wanted, shown.say):
            one, kind = by_name[name]
            if kind == "oracle":
                pieces.keep(name, wanted[name], beliefs.oracle_model(one, study.robots))
            elif study.extended is not None:
                pieces.keep(name, wanted[name], beliefs.given_model(study.extended))
            else:
                tasks.append(beliefs.Preparation(one, log_config(study, one)))
        failures = []
        with closing(made(beliefs.record_and_diagnose, tasks, workers, note=shown.say)) as prepared:
            for done in prepared:
                name = f"{done.task.alteration.name}.extended"
                if done.value is None:
                    failures.append(str(done.error))
                else:
                    pieces.keep(name, wanted[name], done.value)
    if failures:
        raise RunsFailed(f"{len(failures)} models could not be made, first: {failures[0]}")
    return {(one.name, kind): pieces.files(name) for name, (one, kind) in by_name.items()}

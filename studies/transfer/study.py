"""The study from beginning to end: models, runs, comparison, report."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from studies.altered import AlteredRun, Files, keep, read_files, run_altered
from studies.execution import Workers, completed
from studies.paper.directory import StudyDirectory
from studies.paper.execution import RunsFailed, execute
from studies.transfer import beliefs
from studies.transfer.plan import TransferConfig, TransferRun, log_config, plan
from studies.transfer.report import write_report


@dataclass(frozen=True)
class Work:
    """Runs one run; carries the models, so that a worker needs no disk in common."""

    models: dict[tuple[str, str], Files]
    """By alteration and controller; the minimal model is the shipped one."""

    def __call__(self, run: TransferRun) -> dict[str, bytes]:
        """Simulate; the run's files by name. Executed by a worker."""
        model = self.models.get((run.alteration.name, run.controller))
        return run_altered(AlteredRun(run.config, run.effects, model))


def run_transfer(
    study: TransferConfig, out: Path, workers: Workers, *, quiet: bool = False
) -> None:
    """Run or resume the study in `out` and write `transfer.json`, tables, figures and report.

    Raises:
        InputError: `out` or a given model cannot be used, or the scheduler does not answer.
        RunsFailed: some runs raised; the others are kept.
        WorkersLost: workers keep dying.
    """
    runs = plan(study)
    with StudyDirectory(out, study, runs).held() as directory:
        _prepare(study, out, workers)
        models = {
            (one.name, kind): read_files(folder_of(out, one.name, kind))
            for one in study.alterations
            for kind in ("extended", "oracle")
        }
        execute(directory, workers, Work(models), quiet=quiet)
        write_report(directory)


def folder_of(out: Path, alteration: str, kind: str) -> Path:
    """Where a model lies."""
    return out / "models" / f"{alteration}.{kind}"


def _prepare(study: TransferConfig, out: Path, workers: Workers) -> None:
    """Make the models that are missing."""
    missing = []
    for one in study.alterations:
        oracle, extended = (folder_of(out, one.name, kind) for kind in ("oracle", "extended"))
        if not oracle.is_dir():
            beliefs.keep_oracle(one, study.robots, oracle)
        if extended.is_dir():
            continue
        if study.extended is not None:
            beliefs.keep_given(study.extended, extended)
        else:
            missing.append(beliefs.Preparation(one, log_config(study, one)))
    failures = []
    with closing(completed(beliefs.record_and_diagnose, missing, workers)) as prepared:
        for done in prepared:
            if done.value is None:
                failures.append(str(done.error))
            else:
                keep(done.value, folder_of(out, done.task.alteration.name, "extended"))
    if failures:
        raise RunsFailed(f"{len(failures)} models could not be made, first: {failures[0]}")

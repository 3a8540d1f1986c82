"""A study from beginning to end: run what is missing, then make everything from the runs."""

from __future__ import annotations

from pathlib import Path

from realitygap.studies.paper.conditions import STUDIED, StudyConfig, plan
from realitygap.studies.paper.directory import StudyDirectory
from realitygap.studies.paper.execution import execute, run_files
from realitygap.studies.paper.readings import reading_conditions
from realitygap.studies.paper.readings_report import dependence_line, write_readings
from realitygap.studies.paper.report import write_report
from realitygap.studies.paper.results import outcome
from realitygap.studies.paper.rounds import Rounds
from realitygap.studies.plumbing.execution import Workers


def run_study(study: StudyConfig, out: Path, workers: Workers, *, quiet: bool = False) -> str:
    """Run or resume a study in `out` and write its tables, figures and report.

    Returns:
        What came out, in one line.

    Raises:
        InputError: `out` cannot be used or the scheduler does not answer.
        RunsFailed: some runs raised; the others are kept.
        WorkersLost: workers keep dying.
    """
    readings = study.study == "readings"
    runs = plan(study, reading_conditions() if readings else STUDIED)
    with StudyDirectory(out, study, runs).held() as directory:
        if study.until_decided:
            Rounds(directory, workers, write_report, quiet).finish()
        else:
            execute(directory, workers, run_files, quiet=quiet)
        if readings:
            return dependence_line(write_readings(directory))
        return outcome(write_report(directory))

"""A battery from beginning to end: the trials that are missing, then the scores and the page."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.studies.blind.directory import BlindDirectory
from realitygap.studies.blind.examiner import ask
from realitygap.studies.blind.known import known_effects
from realitygap.studies.blind.record import Diagnosed, Task, run_trial
from realitygap.studies.blind.report import write_report
from realitygap.studies.blind.summary import summarise
from realitygap.studies.blind.trials import BlindConfig, blind_config, plan
from realitygap.studies.plumbing.execution import Unfinished, Workers
from realitygap.studies.plumbing.manifest import made
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.progress import Progress
from realitygap.studies.plumbing.provenance import write_json


class TrialsFailed(Unfinished):
    """Some trials could not be recorded; the others are kept."""


def blind(
    out: Path | str,
    *,
    trials: int = 200,
    seed: int = 0,
    only: Sequence[str] = (),
    at_bars: bool = False,
    crowd: int = 1,
    kinds: Sequence[str] = (),
    leave_one_out: bool = False,
    seconds: Sequence[float] = (),
    build_spread: float = 0.0,
    engine: str = DEFAULT,
    jobs: int | None = None,
    scheduler: str | None = None,
    quiet: bool = True,
) -> dict[str, Any]:
    """Hide effects at random, diagnose each log in a process that has nothing else, and score.

    Args:
        out: The battery's directory; an unfinished one is resumed.
        trials: Runs; a larger number extends a battery.
        seed: Everything random follows from it.
        only: Effects to draw from; all that the diagnosis knows if absent.
        at_bars: Every effect exactly at its bar, in 120 s.
        crowd: Robots of a run that each have an effect of their own.
        kinds: healthy, single, swarm, pair or unlisted, in turn; single at the bars, else all.
        leave_one_out: Hide effects whose cause the diagnosis must do without.
        seconds: Lengths of the logs (s); 120 most often, 60 or 240 if absent.
        build_spread: Relative standard deviation by which robots' parts differ from nominal.
        engine: Physics of the world: pybullet or mujoco.
        jobs: Processes; all cores if absent.
        scheduler: Address of a Dask scheduler whose workers have this program.
        quiet: Otherwise how far it has come is told on standard error.

    Returns:
        The content of `blind.json`.

    Raises:
        InputError: a value cannot be used, `out` cannot, or the scheduler does not answer.
        Unfinished: trials raised errors of their own; the same call goes on with them.
    """
    lengths = {"seconds": tuple(seconds)} if seconds else {}
    config = blind_config(
        trials=trials,
        seed=seed,
        effects=tuple(only) or known_effects(),
        at_bars=at_bars,
        kinds=tuple(kinds),
        leave_one_out=leave_one_out,
        crowd=crowd,
        build_spread=build_spread,
        engine=engine_name(engine),
        **lengths,
    )
    return run_battery(config, Path(out), Workers.chosen(jobs, scheduler), quiet=quiet)


def run_battery(
    config: BlindConfig,
    out: Path,
    workers: Workers,
    *,
    quiet: bool = False,
    diagnosed: Diagnosed = ask,
) -> dict[str, Any]:
    """Run or resume a battery in `out`; returns the content of `blind.json`.

    Args:
        config: Which trials.
        out: The battery's directory.
        workers: Where trials run; each records and has its log diagnosed.
        quiet: Say nothing.
        diagnosed: What diagnoses the log in a directory; importable.

    Raises:
        InputError: `out` cannot be used.
        TrialsFailed: trials raised errors of their own; a failed diagnosis is a result.
        WorkersLost: workers keep dying.
    """
    with BlindDirectory(out, config, plan(config)).held() as directory:
        _execute(directory, workers, quiet, diagnosed)
        summary = summarise(directory)
        with whole_file(out / "blind.json", force=True) as part:
            write_json(part, summary)
        write_report(directory, summary)
    return summary


def _execute(
    directory: BlindDirectory, workers: Workers, quiet: bool, diagnosed: Diagnosed
) -> None:
    """Do the trials that are missing."""
    flaws: list[str] = []
    tasks = [Task(trial, diagnosed) for trial in directory.pending(flaws.append)]
    if not tasks:
        return
    failures = []
    total = sum(task.trial.seconds for task in tasks)
    done = 0.0
    with (
        Progress("trials", total, quiet) as shown,
        closing(made(run_trial, tasks, workers, note=shown.say)) as finished,
    ):
        for flaw in flaws:
            shown.say(flaw)
        for one in finished:
            trial = one.task.trial
            done += trial.seconds
            if one.value is None:
                failures.append(f"trial {trial.name}: {one.error}")
            else:
                directory.keep(trial, one.value)
            shown.reach(done)
    if failures:
        raise TrialsFailed(f"{len(failures)} trials failed, first {failures[0]}")

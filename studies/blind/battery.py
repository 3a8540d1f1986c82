"""A battery from beginning to end: the trials that are missing, then the scores and the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from realitygap.embedded_sim.errors import InputError
from realitygap.models.belief.catalogue import every_cause
from realitygap.reality.engine import DEFAULT, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, rays_name
from realitygap.studies.blind.conditions.battery import run_matrix
from realitygap.studies.blind.conditions.matrix import matrix_config
from realitygap.studies.blind.directory import BlindDirectory, do_missing
from realitygap.studies.blind.examiner import ask
from realitygap.studies.blind.record import Diagnosed, run_trial
from realitygap.studies.blind.report import write_report
from realitygap.studies.blind.summary import summarise
from realitygap.studies.blind.trials import BlindConfig, blind_config, plan
from realitygap.studies.diagnosis.references import lasting_reference, reference_files
from realitygap.studies.hidden.menu import MENU
from realitygap.studies.plumbing.execution import Workers
from realitygap.studies.plumbing.output import whole_file
from realitygap.studies.plumbing.provenance import write_json


def known_effects() -> tuple[str, ...]:
    """Names in the menu's order."""
    return tuple(name for name in MENU if name in every_cause())


def blind(
    out: Path | str,
    *,
    trials: int | None = None,
    seed: int = 0,
    only: Sequence[str] = (),
    at_bars: bool = False,
    crowd: int = 1,
    kinds: Sequence[str] = (),
    leave_one_out: bool = False,
    seconds: Sequence[float] = (),
    build_spread: float = 0.0,
    conditions: bool = False,
    engine: str = DEFAULT,
    rays: str = DEFAULT_RAYS,
    reference: Path | str | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    quiet: bool = True,
) -> dict[str, Any]:
    """Hide effects at random, diagnose each log in a process that has nothing else, and score.

    Args:
        out: The battery's directory; an unfinished one is resumed.
        trials: Runs, 200 if absent, or logs of each cell, 10; a larger number extends a battery.
        seed: Everything random follows from it.
        only: Effects to draw from, or conditions; all that are known if absent.
        at_bars: Every effect exactly at its bar, in 120 s.
        crowd: Robots of a run that each have an effect of their own.
        kinds: healthy, single, swarm, pair or unlisted, in turn; single at the bars, else all.
        leave_one_out: Hide effects whose cause the diagnosis must do without.
        seconds: Lengths of the logs (s); 120 most often, 60 or 240 if absent.
        build_spread: Relative standard deviation by which robots' parts differ from nominal.
        conditions: Diagnose one log under many conditions instead (docs/conditions.md).
        engine: Physics of the world: pybullet, pybullet-strict or mujoco.
        rays: Who answers what infrared meets: engine, or closed.
        reference: Healthy reference of every diagnosis, as `diagnose` takes it.
        jobs: Processes; all cores if absent.
        scheduler: Address of a Dask scheduler whose workers have this program.
        quiet: Otherwise how far it has come is told on standard error.

    Returns:
        The content of `blind.json`, or of `conditions.json`.

    Raises:
        InputError: a value cannot be used, `out` cannot, or the scheduler does not answer.
        Unfinished: trials raised errors of their own; the same call goes on with them.
    """
    workers = Workers.chosen(jobs, scheduler)
    common: dict[str, Any] = {"seed": seed, "engine": engine_name(engine), "rays": rays_name(rays)}
    common |= {} if trials is None else {"trials": trials}
    if reference is not None:
        lasting = lasting_reference(reference)
        common |= {"reference": lasting, "inputs": tuple(reference_files(lasting))}
    draws = {"at_bars": at_bars, "kinds": tuple(kinds), "leave_one_out": leave_one_out}
    draws |= {"crowd": crowd, "build_spread": build_spread}
    draws |= {"seconds": tuple(seconds)} if seconds else {}
    if conditions:
        _refuse_draws(draws)
        names = {"conditions": tuple(only)} if only else {}
        return run_matrix(matrix_config(**common, **names), Path(out), workers, quiet=quiet)
    config = blind_config(**common, **draws, effects=tuple(only) or known_effects())
    return run_battery(config, Path(out), workers, quiet=quiet)


def _refuse_draws(draws: Mapping[str, Any]) -> None:
    """Refuse what says how effects are drawn, where none are."""
    for name, value in draws.items():
        if value != BlindConfig.model_fields[name].default:
            option = {"kinds": "kind"}.get(name, name.replace("_", "-"))
            got = ", ".join(map(str, value)) if isinstance(value, tuple) else value
            raise InputError(f"--{option}", got, "nothing with --conditions")


def run_battery(
    config: BlindConfig,
    out: Path,
    workers: Workers,
    *,
    quiet: bool = False,
    diagnosed: Diagnosed | None = None,
) -> dict[str, Any]:
    """Run or resume a battery in `out`; returns the content of `blind.json`.

    Args:
        config: Which trials.
        out: The battery's directory.
        workers: Where trials run; each records and has its log diagnosed.
        quiet: Say nothing.
        diagnosed: What diagnoses the log in a directory; importable; `ask` if absent.

    Raises:
        InputError: `out` cannot be used.
        TrialsFailed: trials raised errors of their own; a failed diagnosis is a result.
        WorkersLost: workers keep dying.
    """
    with BlindDirectory(out, config, plan(config)).held() as directory:
        who = diagnosed or partial(ask, reference=config.reference)
        do_missing(directory, workers, quiet, who, run_trial)
        summary = summarise(directory)
        with whole_file(out / "blind.json", force=True) as part:
            write_json(part, summary)
        write_report(directory, summary)
    return summary

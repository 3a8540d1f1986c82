"""A healthy reference from logs, or from healthy runs recorded for it, on every core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.probes import MENU, PREFIX
from realitygap.models.belief.catalogue import where
from realitygap.models.belief.senses import Belief
from realitygap.models.gap.sensor_gap import sensors_to_judge
from realitygap.models.log.held_out import parts
from realitygap.models.naming.channels.motion.claims import farthest_error
from realitygap.models.naming.channels.motion.tracks import Tracks, cut_tracks
from realitygap.models.naming.channels.senses.robot import SenseLog
from realitygap.models.naming.channels.senses.sight import look
from realitygap.models.naming.engine.health import Told
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.health.learned import (
    fit_inherent,
    make_reference,
    told_by,
    told_of,
    with_errors,
)
from realitygap.models.naming.health.reference import (
    LIKE,
    Reference,
    read_reference,
    write_reference,
)
from realitygap.models.naming.health.senses import (
    SenseReference,
    beside,
    make_sense_reference,
    read_sense_reference,
    write_sense_reference,
)
from realitygap.reality.engine import DEFAULT, EngineName, engine_name
from realitygap.reality.rays import DEFAULT_RAYS, RaysName, rays_name
from realitygap.studies.inputs.logs import AnyLog, Source, read_logs, sources
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.plumbing.execution import Workers, processes
from realitygap.studies.plumbing.output import readable, whole_file
from realitygap.studies.plumbing.rooms import scratch
from realitygap.studies.plumbing.typed import option, typed


def sense_reference_of(
    logs: Sequence[Source], model: Model, pool: Executor, *, command: str
) -> SenseReference | None:
    """A healthy reference of the senses; None where the model or the logs have no sensors.

    Args:
        logs: Of healthy robots.
        model: What is believed of them.
        pool: What works through the logs.
        command: What a user would type.

    Raises:
        InputError: a log cannot be used.
    """
    if model.tables is None:
        return None
    told = [one for one in pool.map(_told, [(log, model) for log in logs]) if one is not None]
    if not told:
        return None
    return make_sense_reference(told, model=model.name, command=command)


@one_thread
def _told(task: tuple[Source, Model]) -> Told | None:
    """What one healthy log's readings and answers say; None where it has no sensors."""
    log, model = task
    measured, point = read_logs(log, model.file), model.point()
    if not sensors_to_judge(measured, point):
        return None
    seen = SenseLog(measured, point, look(measured, point), of_log=parts(measured))
    base = [Belief(senses=point.senses)] * len(seen.robots)
    return told_by(seen.at(range(len(base)), base))


SAMPLE = 9
"""Logs, evenly among all, whose median gives the inherent motion: more differ from it no less than
from each other. Of several worlds, the mean of their medians. Our choice; an odd number."""
MINUTES = 2.0
"""Simulated, of a recorded run: what a diagnosis is usually made of."""
KINDS = (
    ("search", "no-light"),
    ("coevolution", "light-at-nest"),
    ("search", "no-light"),
    ("coevolution", "light-opposite-nest"),
)
"""Controller and case of the recorded runs, in turn: health must hold whatever robots do."""
MANOEUVRES = (
    *((PREFIX + name, "no-light" if one.dark else "light-at-nest") for name, one in MENU.items()),
    *KINDS[:3],
)
"""The same where health must hold for robots that perform manoeuvres, and forage besides."""


@dataclass(frozen=True, kw_only=True)
class ReferenceRequest:
    """What to measure health from."""

    logs: tuple[Source, ...] = ()
    runs: int = 0
    manoeuvres: bool = False
    seed: int = 0
    engines: tuple[EngineName, ...] = (DEFAULT,)
    """Of the recorded runs' worlds, by turns."""
    rays: RaysName = DEFAULT_RAYS
    model: Model
    jobs: int | None = None

    @property
    def command(self) -> str:
        """What a user would type."""
        words: list[object] = ["realitygap", "reference", *(one.typed for one in self.logs)]
        words += ["--runs", self.runs, "--seed", self.seed] if self.runs else []
        usual = not self.runs or self.engines == (DEFAULT,)
        words += [] if usual else option("--engine", self.engines)
        words += ["--rays", self.rays] if self.runs and self.rays != DEFAULT_RAYS else []
        words += ["--manoeuvres"] if self.manoeuvres else []
        words += ["--model", self.model.typed] if self.model.typed else []
        return typed(*words)


def measure_health(
    log: AnyLog = (),
    *,
    out: Path | str,
    model: AnyModel = None,
    runs: int = 0,
    manoeuvres: bool = False,
    seed: int = 0,
    engine: str | Sequence[str] = DEFAULT,
    rays: str = DEFAULT_RAYS,
    jobs: int | None = None,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> Reference:
    """Measure health: what sound robots do beyond the model, and how much they differ.

    Args:
        log: Measured logs of sound robots, as `read_log` takes them.
        out: Where to write the reference (JSON); that of the senses is written beside it.
        model: What is believed of the robots; the e-puck if absent.
        runs: Healthy runs of the nominal world to record, two minutes each.
        manoeuvres: Record the manoeuvres of `probe:NAME` in turn.
        seed: Of the recorded runs.
        engine: Physics of their worlds: pybullet, pybullet-strict or mujoco; several by turns.
        rays: Who answers what infrared meets: engine, or closed.
        jobs: Processes; all cores if absent.
        force: Replace a reference that is there.
        reach: Called with the share that is done, from 0 to 1.

    Raises:
        InputError: neither logs nor runs, a log or the model cannot be used, or `out` cannot.
    """
    engines = (engine,) if isinstance(engine, str) else engine
    request = ReferenceRequest(
        logs=sources(log),
        runs=runs,
        manoeuvres=manoeuvres,
        seed=seed,
        engines=tuple(engine_name(one, needed=runs > 0) for one in engines),
        rays=rays_name(rays),
        model=Model.load(model),
        jobs=jobs,
    )
    if not request.logs and request.runs < 1:
        raise InputError("LOG", "nothing", "logs of healthy robots, or --runs to record some")
    target = Path(out)
    motion, seen = readable(read_reference), readable(read_sense_reference)
    with (
        whole_file(target, force=force, ours=motion) as part,
        whole_file(beside(target), force=force, ours=seen, needed=False) as sense_part,
    ):
        made, senses = _measured(request, reach)
        write_reference(made, part)
        if senses is not None:
            write_sense_reference(senses, sense_part)
    return made


def _measured(
    request: ReferenceRequest, reach: Callable[[float], None]
) -> tuple[Reference, SenseReference | None]:
    """The references of motion and, where there are any, of the senses."""
    model = request.model
    inputs = (*(log.entry("LOG") for log in request.logs), *model.entries())
    jobs = Workers.chosen(request.jobs, None).jobs
    done, total = 0.0, len(request.logs) + 2.0 * request.runs

    def step(count: float) -> None:
        nonlocal done
        done += count
        reach(done / total)

    # logs hold no world, whose engine must be kept apart: with one job they need no process
    alone = jobs == 1 and not request.runs
    with scratch() as room, ThreadPoolExecutor(1) if alone else processes(jobs) as pool:
        kinds = MANOEUVRES if request.manoeuvres else KINDS
        tasks = [(request, k, kinds[k % len(kinds)], room) for k in range(request.runs)]
        recorded = []
        for path in pool.map(_record, tasks):
            recorded.append(Source(path))
            step(1.0)
        logs = [*request.logs, *recorded]
        inherent: dict[str, list[FloatArray]] = {}
        some = sorted({*np.linspace(0, len(logs) - 1, SAMPLE).round().astype(int).tolist()})
        for recorder, found in pool.map(_inherent, [(logs[k], model) for k in some]):
            inherent.setdefault(recorder, []).append(found)
            step(0.3 * len(logs) / len(some))
        # halfway between worlds, which are then as far from it in what swarms have in common
        common = np.mean([np.median(each, axis=0) for each in inherent.values()], axis=0)
        swarms: list[Told] = []
        for healthy in pool.map(_terms, [(log, model, common) for log in logs]):
            swarms.append(healthy)
            step(0.7)
        drive = model.file.motion().drive
        made = make_reference(
            swarms, common, model=model.name, drive=drive, command=request.command
        )
        errors, recorders, steps = zip(
            *pool.map(_error, [(log, model, made) for log in logs]), strict=True
        )
        made = with_errors(made, errors)
        if len({*recorders}) == 1 and max(steps) - min(steps) < LIKE * min(steps):
            made = made.model_copy(update={"recorder": recorders[0], "step": steps[0]})
        senses = sense_reference_of(logs, model, pool, command=request.command)
    return made.model_copy(update={"inputs": inputs}), senses


def _record(task: tuple[ReferenceRequest, int, tuple[str, str], Path]) -> Path:
    """Record one healthy run of the nominal world."""
    from realitygap.studies.run.experiment import RunConfig, simulate

    request, number, (controller, case), room = task
    out = room / f"run{number}"
    out.mkdir()
    kinds = len(MANOEUVRES if request.manoeuvres else KINDS)
    config = RunConfig.model_validate(
        {
            "case": case,
            "controller": controller,
            "minutes": MINUTES,
            "seed": int(np.random.SeedSequence([request.seed, number]).generate_state(1)[0]),
            "engine": request.engines[number // kinds % len(request.engines)],
            "rays": request.rays,
        }
    )
    simulate(config, (), out)
    return out


def _tracks(log: Source, model: Model) -> Tracks:
    return cut_tracks(read_logs(log, model.file), model.file)


def _inherent(task: tuple[Source, Model]) -> tuple[str, FloatArray]:
    """What recorded a healthy log, and the inherent motion of its robots."""
    log = read_logs(task[0], task[1].file)
    return log.recorder, fit_inherent(cut_tracks(log, task[1].file), task[1].file.motion().drive)


def _terms(task: tuple[Source, Model, FloatArray]) -> Told:
    from realitygap.models.belief.motion import Motion
    from realitygap.models.naming.health.reference import INHERENT

    log, model, inherent = task
    believed = Motion(drive=model.file.motion().drive)
    with where(model.file.robot.drive_kind):
        return told_of(_tracks(log, model), INHERENT.applied(believed, inherent))


def _error(task: tuple[Source, Model, Reference]) -> tuple[float, str, float]:
    """How far the healthy model's predictions of one healthy log are off at most, what recorded it,
    and s between its rows."""
    source, model, reference = task
    log = read_logs(source, model.file)
    tracks = cut_tracks(log, model.file)
    return farthest_error(log, model.file, reference, tracks), log.recorder, log.step

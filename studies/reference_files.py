"""A healthy reference from logs, or from healthy runs recorded for it, on every core."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from realitygap.embedded_sim.errors import InputError
from realitygap.embedded_sim.model import FloatArray
from realitygap.embedded_sim.probes import MENU, PREFIX
from realitygap.models.identify.healthy import Healthy, fit_inherent, fit_terms, make_reference
from realitygap.models.identify.tracks import Tracks, cut_tracks
from realitygap.models.log import read_log
from realitygap.models.modelfile import load_common, read_model_file
from realitygap.models.reference import Reference, read_reference, write_reference
from realitygap.models.senses.reference import (
    SenseReference,
    beside,
    read_sense_reference,
    write_sense_reference,
)
from realitygap.studies.execution import Workers, processes
from realitygap.studies.output import readable, whole_file
from realitygap.studies.provenance import log_read, model_read
from realitygap.studies.rooms import scratch
from realitygap.studies.sense_reference_files import sense_reference_of
from realitygap.studies.typed import typed

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

    logs: tuple[Path, ...] = ()
    runs: int = 0
    manoeuvres: bool = False
    seed: int = 0
    model: str | None = None
    jobs: int | None = None

    @property
    def command(self) -> str:
        """What a user would type."""
        words: list[object] = ["realitygap", "reference", *self.logs]
        words += ["--runs", self.runs, "--seed", self.seed] if self.runs else []
        words += ["--manoeuvres"] if self.manoeuvres else []
        words += ["--model", self.model] if self.model else []
        return typed(*words)


def write_reference_of(
    request: ReferenceRequest,
    out: Path,
    *,
    force: bool = False,
    reach: Callable[[float], None] = lambda done: None,
) -> Reference:
    """Fit a healthy reference and write it.

    Raises:
        InputError: neither logs nor runs, or a log cannot be used.
    """
    if not request.logs and request.runs < 1:
        raise InputError("LOG", "nothing", "logs of healthy robots, or --runs to record some")
    motion, seen = readable(read_reference), readable(read_sense_reference)
    with (
        whole_file(out, force=force, ours=motion) as part,
        whole_file(beside(out), force=force, ours=seen, needed=False) as sense_part,
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
    model = read_model_file(request.model)
    load_common(request.model, sensors="declared")  # refused now, not after all runs
    inputs = (*(log_read("LOG", path) for path in request.logs), *model_read(request.model))
    jobs = Workers.chosen(request.jobs, None).jobs
    done = 0.0

    def step(count: float) -> None:
        nonlocal done
        done += count
        reach(done)

    with scratch() as room, processes(jobs) as pool:
        kinds = MANOEUVRES if request.manoeuvres else KINDS
        tasks = [(k, kinds[k % len(kinds)], request.seed, room) for k in range(request.runs)]
        recorded = []
        for path in pool.map(_record, tasks):
            recorded.append(path)
            step(1.0)
        paths = [*request.logs, *recorded]
        inherent = []
        for found in pool.map(_inherent, [(path, request.model) for path in paths]):
            inherent.append(found)
            step(0.3)
        common = np.median(inherent, axis=0)
        swarms: list[Healthy] = []
        for healthy in pool.map(_terms, [(path, request.model, common) for path in paths]):
            swarms.append(healthy)
            step(0.7)
        senses = sense_reference_of(paths, request.model, pool, command=request.command)
    drive = model.motion().drive
    made = make_reference(swarms, common, model=model.name, drive=drive, command=request.command)
    return made.model_copy(update={"inputs": inputs}), senses


def _record(task: tuple[int, tuple[str, str], int, Path]) -> Path:
    """Record one healthy run of the nominal world."""
    from realitygap.studies.experiment import RunConfig, simulate

    number, (controller, case), seed, room = task
    out = room / f"run{number}"
    out.mkdir()
    config = RunConfig.model_validate(
        {
            "case": case,
            "controller": controller,
            "minutes": MINUTES,
            "seed": int(np.random.SeedSequence([seed, number]).generate_state(1)[0]),
        }
    )
    simulate(config, (), out)
    return out


def _tracks(path: Path, model: str | None) -> Tracks:
    believed = read_model_file(model)
    return cut_tracks(read_log(path, drive=believed.nominal_drive), believed)


def _inherent(task: tuple[Path, str | None]) -> FloatArray:
    return fit_inherent(_tracks(*task), read_model_file(task[1]).motion().drive)


def _terms(task: tuple[Path, str | None, FloatArray]) -> Healthy:
    from realitygap.models.causes import Motion
    from realitygap.models.identify.inherent import INHERENT

    path, model, inherent = task
    believed = Motion(drive=read_model_file(model).motion().drive)
    return fit_terms(_tracks(path, model), INHERENT.applied(believed, inherent))

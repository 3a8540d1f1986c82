"""Diagnosis: measured logs in; verdict, causes and the extended model out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.models.belief.catalogue import every_cause, where
from realitygap.models.belief.catalogue import without as withholding
from realitygap.models.naming.channels.motion.diagnose import diagnose as diagnose_motion
from realitygap.models.naming.channels.senses.joined import WholeExamination, with_senses
from realitygap.models.naming.diagnosis import as_json, extension
from realitygap.models.naming.frame import in_the_models_frame
from realitygap.models.naming.preflight import HEADINGS
from realitygap.models.naming.proposal.propose import with_proposal
from realitygap.models.naming.rules import Rules
from realitygap.models.naming.strangers import without_strangers
from realitygap.studies.diagnosis.next_experiment import commands, plan
from realitygap.studies.diagnosis.references import reference_files, references
from realitygap.studies.diagnosis.request import Request
from realitygap.studies.diagnosis.result import FILE, DiagnosisResult
from realitygap.studies.diagnosis.rules import changed
from realitygap.studies.inputs.logs import AnyLog, Log, as_log, log_hash
from realitygap.studies.inputs.model import AnyModel, Model
from realitygap.studies.plumbing.output import whole_directory
from realitygap.studies.plumbing.progress import unseen
from realitygap.studies.plumbing.provenance import versions


def diagnose(
    log: AnyLog,
    *,
    model: AnyModel = None,
    reference: Path | str | None = None,
    without: Sequence[str] = (),
    rules: Rules = Rules(),
    seed: int = 0,
    out: Path | str | None = None,
    force: bool = False,
    begin: Callable[[str], None] = unseen,
) -> DiagnosisResult:
    """Name the cause: which physical fault, of which robots, how large, and how sure.

    Args:
        log: A measured log or several, as `read_log` takes them.
        model: What the robots' simulators believe; that of the log, or the e-puck, if absent.
        reference: Healthy reference: a file (JSON), "pybullet" or "mujoco" for a shipped one, or
            "none"; that of the world that recorded the log, else pybullet's, if absent.
        without: Causes of the catalogue to do without, as if unknown.
        rules: What naming is tuned to; `rules()` lists it.
        seed: Of the resampling.
        out: Directory to write everything into as well, as `write` does; claimed before any work.
        force: Replace a diagnosis that is there.
        begin: Called with the name of each stage.

    Raises:
        InputError: a log, model, reference or name of a cause cannot be used, or `out` cannot.
        Diverged: a replay left the finite numbers.
    """
    holds = (FILE,)
    place = nullcontext() if out is None else whole_directory(Path(out), force=force, holds=holds)
    with place as part:
        for name in without:
            if name not in every_cause():
                raise InputError("--without", repr(name), nearest(name, every_cause()))
        if not (isinstance(log, Log) and model is None):
            model = Model.load(model)  # refused before the log is read
        begin("reading the log")
        read = as_log(log, model)
        request = Request(
            logs=read.sources,
            model=read.model,
            reference=None if reference is None else str(reference),
            seed=seed,
            without=tuple(without),
        )
        found = _result(request, *_examined(request, read, rules, begin))
        if part is not None:
            begin("writing the report")
            found.keep(part)
    return found


def _examined(
    request: Request, log: Log, rules: Rules, begin: Callable[[str], None]
) -> tuple[Log, WholeExamination]:
    """The log as it was judged, in the frame of the model's arena, and all that is said of it."""
    model, measured, seed = log.model, log.measured, request.seed
    healthy, senses = references(request.reference, measured, model.file)
    alike = healthy is not None and healthy.recorded_like(measured.recorder, measured.step)
    robot = model.file.robot
    hidden = (*request.without, *(() if measured.headed else HEADINGS))
    with withholding(hidden), where(robot.drive_kind, measured=healthy is not None):
        begin("motion")
        measured, placed = in_the_models_frame(
            measured, model.file, model.tables, alike=alike, rules=rules
        )
        if model.file.arena is not None and not alike:
            point = model.file.point_model(model.tables)
            measured, strangers = without_strangers(measured, point)
            placed = (*placed, *strangers)
        motion = diagnose_motion(
            measured, model.file, healthy, rules=rules, seed=seed, name=model.label
        )
        begin("senses")
        examined = with_senses(motion, measured, model.tables, senses, seed=seed)
        begin("the next experiment")
        whole = with_proposal(examined, measured, model.tables)
    told = {entry.name: entry for entry in (*whole.diagnosis.preflight, *placed)}
    said = replace(whole.diagnosis, names=measured.names, preflight=tuple(told.values()))
    return replace(log, measured=measured), replace(whole, diagnosis=said)


def _result(request: Request, log: Log, examined: WholeExamination) -> DiagnosisResult:
    """What is told of it."""
    found = examined.diagnosis
    content = as_json(found) | {"inputs": _inputs(request), "versions": versions()}
    if other := changed(found.rules):
        content["rules"] = other
    following: tuple[str, ...] = ()
    if found.proposal is not None:
        following = commands(found.proposal, request, log.measured)
        content["next_experiment"]["commands"] = list(following)
        content["next_experiment"]["plan"] = plan(found.proposal, log.model.file, log.measured)
    named = extension(found, log_hash=log_hash(request.logs), command=request.command)
    return DiagnosisResult(
        content=content,
        extended=request.model.extended(named),
        command=request.command,
        next_commands=following,
        examined=examined,
        log=log,
    )


def _inputs(request: Request) -> list[dict[str, str]]:
    """The files that a diagnosis is a function of."""
    read = [*(log.entry("LOG") for log in request.logs), *request.model.entries()]
    return [*read, *reference_files(request.reference)]

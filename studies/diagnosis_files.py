"""Diagnosis as files: measured logs in; diagnosis.json, extended.toml and report.html out."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.models.catalogue import every_cause
from realitygap.models.causes.withheld import without
from realitygap.models.diagnosis import Diagnosis, as_json, extension, file_hash
from realitygap.models.extended import NAME, extended_text, read_back
from realitygap.models.extension import Extension
from realitygap.models.identify.diagnose import diagnose
from realitygap.models.log import SAMPLES, MeasuredLog, make_log, read_table
from realitygap.models.modelfile import ModelFile, find_model_file, read_model_file
from realitygap.models.proposal.propose import with_proposal
from realitygap.models.reference import Reference, read_reference, shipped_reference
from realitygap.models.repertoire import manoeuvres
from realitygap.models.schema import BODY_COMMANDS, WHEEL_COMMANDS
from realitygap.models.senses.joined import WholeExamination, with_senses
from realitygap.models.senses.reference import (
    SenseReference,
    beside,
    read_sense_reference,
    shipped_sense_reference,
)
from realitygap.models.tables import load_tables
from realitygap.studies.diagnosis_request import Request
from realitygap.studies.next_experiment import commands
from realitygap.studies.output import whole_directory
from realitygap.studies.progress import unseen
from realitygap.studies.provenance import file_read, log_read, model_read, versions, write_json

NO_REFERENCE = "none"


def diagnose_files(
    request: Request, out: Path, *, force: bool = False, begin: Callable[[str], None] = unseen
) -> Diagnosis:
    """Diagnose and write everything into a new directory.

    Args:
        request: What is asked.
        out: The directory.
        force: Replace what is there.
        begin: Called with the name of each stage.

    Raises:
        InputError: as `examine`, or `out` cannot be used.
    """
    with whole_directory(out, force=force, holds=("diagnosis.json",)) as part:
        log, examined = examine(request, begin)
        begin("writing the report")
        path, model, found = find_model_file(request.model), examined.model, examined.diagnosis
        named = extension(found, log_hash=_hash(request.logs), command=request.command)
        from realitygap.studies.diagnosis_report import write_report

        content, following = _content(request, log, found)
        write_json(part / "diagnosis.json", content)
        write_extended(model, path, named, part)
        write_report(examined, part / "report.html", command=request.command, following=following)
    return found


def content_of(request: Request) -> dict[str, Any]:
    """What `diagnosis.json` would hold, and nothing written.

    Raises:
        InputError: as `examine`.
    """
    log, examined = examine(request)
    return _content(request, log, examined.diagnosis)[0]


def _content(
    request: Request, log: MeasuredLog, found: Diagnosis
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Of `diagnosis.json`, and the commands that what it proposes takes."""
    content = as_json(found) | {"inputs": _inputs(request), "versions": versions()}
    following: tuple[str, ...] = ()
    if found.proposal is not None:
        following = commands(found.proposal, request, log)
        content["next_experiment"]["commands"] = list(following)
    return content, following


def _inputs(request: Request) -> list[dict[str, str]]:
    """The files that a diagnosis is a function of."""
    read = [*(log_read("LOG", log) for log in request.logs), *model_read(request.model)]
    if request.reference is not None and request.reference != NO_REFERENCE:
        given = Path(request.reference)
        halves = (given, beside(given))
        read += [file_read("--reference", half) for half in halves if half.is_file()]
    return read


def examine(
    request: Request, begin: Callable[[str], None] = unseen
) -> tuple[MeasuredLog, WholeExamination]:
    """The logs as one, and all that is said about them; `begin` as `diagnose_files`.

    Raises:
        InputError: a log, model, reference or name of a cause cannot be used.
    """
    for name in request.without:
        if name not in every_cause():
            raise InputError("--without", repr(name), nearest(name, every_cause()))
    path = find_model_file(request.model)
    model = read_model_file(path)
    begin("reading the log")
    log = read_logs(request.logs, model)
    scripted = manoeuvres(log)
    healthy = _reference(request.reference, model, scripted)
    tables = None if model.sensors is None else load_tables(path.parent / model.sensors.tables)
    senses = _sense_reference(request.reference, model, scripted)
    with without(request.without):
        begin("motion")
        motion = diagnose(log, model, healthy, seed=request.seed, name=path.name)
        begin("senses")
        examined = with_senses(motion, log, tables, senses, seed=request.seed)
        begin("the next experiment")
        return log, with_proposal(examined, tables)


def read_logs(paths: Sequence[Path], model: ModelFile) -> MeasuredLog:
    """One measured log out of one or several; robots of one id are one robot in all of them.

    Raises:
        InputError: as `models.log.read_log`.
    """
    tables = [read_table(path) for path in paths]
    known: dict[str, Path] = {}
    for path in paths if len(paths) > 1 else ():
        digest = _hash([path])
        if digest in known:
            raise InputError(str(path), f"the same log as {known[digest]}", "each log once")
        known[digest] = path
    first = _commands(tables[0])
    for path, table in zip(paths, tables, strict=True):
        if _commands(table) != first:
            given = " and ".join(_commands(table)) or "no commands"
            raise InputError(str(path), given, f"{' and '.join(first)}, as in {paths[0]}")
    if len(tables) > 1:
        for k, table in enumerate(tables):
            run = table["run"].astype(str) if "run" in table else "run"
            tables[k] = table.assign(run=f"{k + 1}/" + run)
    nominal = model.nominal_drive
    return make_log(pd.concat(tables, ignore_index=True), drive=nominal)


def _commands(table: pd.DataFrame) -> tuple[str, ...]:
    """Which pair of commands a log has."""
    return tuple(name for name in (*WHEEL_COMMANDS, *BODY_COMMANDS) if name in table)


def write_extended(model: ModelFile, source: Path, named: Extension, out: Path) -> None:
    """The model with an extension as `extended.toml`, its sensor tables beside it.

    Raises:
        InputError: the causes together are no model.
    """
    beside_it = None
    if model.sensors is not None:
        tables = source.parent / model.sensors.tables
        shutil.copyfile(tables, out / tables.name)
        beside_it = tables.name
    text = extended_text(model, named, beside_it)
    read_back(text)  # refuses what nobody could load
    (out / NAME).write_text(text, encoding="utf-8")


def _reference(given: str | None, model: ModelFile, scripted: bool) -> Reference | None:
    """The healthy reference asked for, or the shipped one of the model."""
    if given == NO_REFERENCE:
        return None
    if given is not None:
        return read_reference(Path(given))
    return shipped_reference(model.name, manoeuvres=scripted)


def _sense_reference(given: str | None, model: ModelFile, scripted: bool) -> SenseReference | None:
    """The senses' reference beside the one asked for, or the shipped one of the model."""
    if given == NO_REFERENCE:
        return None
    if given is None:
        return shipped_sense_reference(model.name, manoeuvres=scripted)
    path = beside(Path(given))
    return read_sense_reference(path) if path.is_file() else None


def _hash(logs: Sequence[Path]) -> str:
    return file_hash([path / SAMPLES if path.is_dir() else path for path in logs])

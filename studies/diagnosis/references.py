"""Which healthy reference a diagnosis goes by: a file, a shipped one by its world, or none."""

from __future__ import annotations

from pathlib import Path

from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.measured import MeasuredLog
from realitygap.models.log.repertoire import manoeuvres
from realitygap.models.naming.health.reference import (
    WORLDS,
    Reference,
    read_reference,
    shipped_file,
    world_of,
)
from realitygap.models.naming.health.senses import SenseReference, beside, read_sense_reference
from realitygap.studies.plumbing.provenance import file_read

NO_REFERENCE = "none"


def references(
    given: str | None, log: MeasuredLog, model: ModelFile
) -> tuple[Reference | None, SenseReference | None]:
    """The healthy references of motion and of the senses.

    Args:
        given: Which; None: of the world that recorded the log, where that is known, or the usual.
        log: What is to be judged by them.
        model: What is believed of the robots.

    Raises:
        InputError: a file cannot be read.
    """
    if given == NO_REFERENCE:
        return None, None
    world = given or world_of(log.recorder)
    path: Path | None = Path(world)
    if world in WORLDS:
        path = shipped_file(model.name, world=world, manoeuvres=manoeuvres(log))
    if path is None:
        return None, None
    senses = beside(path)
    return read_reference(path), read_sense_reference(senses) if senses.is_file() else None


def reference_files(given: str | None) -> list[dict[str, str]]:
    """The files among what is given, as a result lists what it was made from."""
    if given is None or given in (NO_REFERENCE, *WORLDS):
        return []
    halves = (Path(given), beside(Path(given)))
    return [file_read("--reference", half) for half in halves if half.is_file()]


def lasting_reference(given: Path | str) -> str:
    """The same, for whoever works in another directory.

    Raises:
        InputError: a file cannot be read.
    """
    if str(given) in (NO_REFERENCE, *WORLDS):
        return str(given)
    read_reference(Path(given))
    return str(Path(given).absolute())

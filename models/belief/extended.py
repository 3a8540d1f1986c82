"""The extended model as the text of its file, and read back from it.

What is said of an extended model is said of what the file holds: it is predicted with only after
it has been written and read.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import tomli_w

from realitygap.models.belief.extension import Extension, NamedCause
from realitygap.models.belief.law_tables import WrittenLaw
from realitygap.models.belief.modelfile import ModelFile
from realitygap.models.log.files import checked

NAME = Path("extended.toml")


def extended_text(model: ModelFile, added: Extension, tables: str | None = None) -> str:
    """The text of `extended.toml`.

    Args:
        model: What was believed before; causes that it has already stay.
        added: What was found beyond it.
        tables: File of the captured tables beside it; None: as in the model.
    """
    content: dict[str, Any] = model.model_dump(mode="json", exclude_none=True)
    earlier = model.extension or Extension()
    every = (*earlier.causes, *added.causes)
    causes = [one.model_dump(mode="json", exclude_none=True) for one in every]
    if tables is not None:
        content["sensors"] = {"tables": tables}
    content["extension"] = {"log": added.log, "command": added.command, "causes": causes}
    if laws := (*earlier.laws, *added.laws):
        told = [one.model_dump(mode="json", exclude_none=True) for one in laws]
        content["extension"]["laws"] = told
    if terms := (*earlier.calibration, *added.calibration):
        told = [one.model_dump(mode="json", exclude_none=True) for one in terms]
        content["extension"]["calibration"] = told
    if curves := (*earlier.done_curve, *added.done_curve):
        told = [one.model_dump(mode="json") for one in curves]
        content["extension"]["done_curve"] = told
    if names := earlier.names | added.names:
        content["extension"]["names"] = names
    return tomli_w.dumps(content)


def read_back(text: str) -> ModelFile:
    """The model in a file's text.

    Raises:
        InputError: a model reader would refuse it.
    """
    return checked(ModelFile, tomllib.loads(text), NAME, "a model file")


def as_written(
    model: ModelFile, causes: Sequence[NamedCause], laws: Sequence[WrittenLaw] = ()
) -> ModelFile:
    """The model with causes and laws, as whoever loads its file has it."""
    return read_back(extended_text(model, Extension(causes=tuple(causes), laws=tuple(laws))))

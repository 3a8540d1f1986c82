"""The healthy reference of the senses: how healthy robots' readings and answers differ.

As the reference of motion: for every coefficient the mean beyond the captured tables, and the
spread between robots and between swarms. It is a file of its own beside the motion's.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from realitygap.models.log.files import read_json, write_json
from realitygap.models.naming.engine.health import Health, Told
from realitygap.models.naming.engine.threads import one_thread
from realitygap.models.naming.health.learned import spreads
from realitygap.models.naming.health.reference import Spreads

SCHEMA = 2
"""Of the file. No rule."""
ROUNDING = 1.0 / 12.0
"""counts^2, variance of rounding to whole counts. No rule: of statistics."""
ROUNDED = "ir_offset.counts"
MANY = 10**6
"""Robots and swarms whose spread is as good as known. No rule: as good as infinite."""


class SenseReference(Spreads):
    """What is believed of healthy robots' senses."""

    schema_number: ClassVar[int] = SCHEMA
    schema_version: int = SCHEMA

    @cached_property
    def learned(self) -> Health:
        """The distribution of healthy robots; where nobody measured it, that counts are whole and
        never below zero, so that an offset by a part of a count is no fault."""
        if self.robots:
            return super().learned
        whole = np.array([ROUNDING])
        return Health((ROUNDED,), np.zeros(1), whole[None], whole, MANY, MANY)


@one_thread
def make_sense_reference(swarms: Sequence[Told], *, model: str, command: str) -> SenseReference:
    """One reference from what many healthy logs say."""
    return SenseReference(**spreads(swarms, model=model, command=command))


def no_sense_reference(model: str) -> SenseReference:
    """What is believed where nobody measured healthy robots: that the tables are right."""
    return SenseReference(model=model, robots=0, swarms=0)


def write_sense_reference(reference: SenseReference, path: Path) -> None:
    """Write as JSON, numbers at full precision."""
    write_json(reference, path)


def read_sense_reference(path: Path) -> SenseReference:
    """Read a reference file.

    Raises:
        InputError: there is no such file, or it is not a reference of senses.
    """
    what = "a reference of the senses of `realitygap reference`"
    return read_json(SenseReference, path, what, field="reference of the senses")


def beside(motion: Path) -> Path:
    """Where the reference of the senses lies that belongs to one of motion."""
    return motion.with_suffix(".senses.json")

"""From the words of the command line to a validated configuration."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from realitygap.embedded_sim.errors import InputError, nearest
from realitygap.embedded_sim.genome import reading as reading_by_name
from realitygap.embedded_sim.probes import MENU, PREFIX
from realitygap.studies.run.experiment import Case, Controller, GenomeName, RunConfig

Config = TypeVar("Config", bound=BaseModel)

_WORDS = {
    "case": get_args(Case),
    "controller": (*get_args(Controller), *(PREFIX + name for name in MENU)),
    "genome": get_args(GenomeName),
}


def run_config(**values: Any) -> RunConfig:
    """A run's configuration.

    Raises:
        InputError: the first value that cannot be used.
    """
    for field, words in _WORDS.items():
        if values.get(field, words[0]) not in words:
            raise InputError(f"--{field}", repr(values[field]), nearest(values[field], words))
    reading_by_name(values.get("reading", "default"))
    return checked(RunConfig, values)


def checked(kind: type[Config], values: Mapping[str, Any]) -> Config:
    """A configuration whose fields are named as the options of the command line.

    Raises:
        InputError: the first value that cannot be used.
    """
    try:
        return kind(**values)
    except ValidationError as error:
        first = error.errors()[0]
        option = str(first["loc"][0]).replace("_", "-")
        expected = first["msg"].removeprefix("Input should be ")
        expected = expected if expected.startswith("a ") else f"a value {expected}"
        raise InputError(f"--{option}", first["input"], expected) from None

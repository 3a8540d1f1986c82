"""From the words of the command line to a validated configuration."""

from __future__ import annotations

from typing import Any, get_args

from pydantic import ValidationError

from embedded_sim.errors import InputError, nearest
from embedded_sim.probes import MENU, PREFIX
from embedded_sim.reading import reading as reading_by_name
from studies.experiment import Case, Controller, GenomeName, RunConfig

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
    try:
        return RunConfig(**values)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        expected = first["msg"].removeprefix("Input should be ")
        raise InputError(f"--{field}", first["input"], f"a value {expected}") from None

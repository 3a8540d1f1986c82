"""The model that a diagnosis would write if it knew everything: true parameters from the truth."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from realitygap.models.belief.catalogue import every_cause
from realitygap.models.belief.extension import Extension, NamedCause, ParameterValue
from realitygap.reality.effects import HiddenEffect
from realitygap.studies.hidden.shares import as_told, given
from realitygap.studies.inputs.model import Model


def oracle(hidden: Iterable[HiddenEffect]) -> Extension:
    """The causes and values of what is hidden, as a model's extension.

    Raises:
        InputError: an effect that the point model has no term for.
    """
    return Extension(command="oracle: true parameters", causes=tuple(map(_cause, hidden)))


def _cause(hidden: HiddenEffect) -> NamedCause:
    name = hidden.effect.name
    cause, values = every_cause()[name], as_told(name, hidden.values)
    asked = (*cause.parameters, *cause.given)
    values |= given(name)
    return NamedCause(
        name=name,
        robots=hidden.robots or "all",
        word=str(values[cause.word]) if cause.word else "",
        parameters={
            p.name: ParameterValue(value=float(values[p.name]), unit=p.unit) for p in asked
        },
    )


def write_oracle(hidden: Iterable[HiddenEffect], out: Path) -> None:
    """Write the shipped e-puck, corrected, as `extended.toml` with its sensor tables."""
    Model.load().extended(oracle(hidden)).keep(out)

"""What values the columns of a measured log may hold, as a schema of pandera."""

from __future__ import annotations

from typing import Any

import pandas as pd
import pandera.errors
import pandera.pandas as pa

from realitygap.embedded_sim.errors import InputError
from realitygap.models.log.schema import (
    BODY_COMMANDS,
    CARRIED,
    CASES,
    ENCODERS,
    LS,
    POSE,
    PS,
    SWITCHING,
    UNITS,
    VIRTUAL,
    WHEEL_COMMANDS,
)

_LIMIT = 1e12
"""Beyond any unit's largest plausible number (nanoseconds of an hour are 3.6e12 only in `t`)."""


def _numbers(*, nullable: bool = True, limit: float = _LIMIT) -> pa.Column:
    """A float column within a sane range."""
    checks = pa.Check.in_range(-limit, limit, error=f"finite numbers within {limit:g}")
    return pa.Column(float, checks, nullable=nullable, coerce=True, required=False)


SCHEMA = pa.DataFrameSchema(
    {
        "run": pa.Column(str, coerce=True, required=False),
        "robot": pa.Column(int, pa.Check.ge(0, error="whole numbers from 0"), coerce=True),
        "t": _numbers(limit=1e20),
        **{name: _numbers() for name in (*POSE, *WHEEL_COMMANDS, *BODY_COMMANDS)},
        **{name: _numbers() for name in (*ENCODERS, *CARRIED, *PS, *LS)},
        **{
            name: pa.Column("boolean", nullable=True, coerce=True, required=False)
            for name in VIRTUAL
        },
        "case": pa.Column(
            str,
            pa.Check.isin((*CASES, *SWITCHING), error=f"one of {', '.join((*CASES, *SWITCHING))}"),
            nullable=True,
            coerce=True,
            required=False,
        ),
    },
    strict=False,
)
"""What values the columns may hold; which columns must be there is `check_columns`' business."""


def checked(known: pd.DataFrame) -> pd.DataFrame:
    """The known columns with their types.

    Raises:
        InputError: a value cannot be read as its column's type or is out of any range.
    """
    try:
        typed: pd.DataFrame = SCHEMA.validate(known)
    except pandera.errors.SchemaError as error:
        raise _refusal(error, known) from None
    except pandera.errors.SchemaErrors as errors:
        raise _refusal(errors.schema_errors[0], known) from None
    return typed


def _refusal(error: pandera.errors.SchemaError, frame: pd.DataFrame) -> InputError:
    """One line out of pandera's report."""
    cases: Any = error.failure_cases
    column = str(getattr(error.schema, "name", None) or error.column_name or "log")
    wrong = cases["failure_case"].iloc[0] if isinstance(cases, pd.DataFrame) else cases
    said = str(getattr(error.check, "error", None) or error.check or "")
    if "coerce" in said or not said:
        unit = UNITS.get(column) or ("whole numbers" if column == "robot" else "text")
        said = {"bool": "true or false"}.get(unit, f"numbers ({unit})" if unit else "text")
        said = "whole numbers" if column == "robot" else said
        said += "; dates are for `realitygap import csv`" if column == "t" else ""
    return InputError(f"column {column}", wrong, said)

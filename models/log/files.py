"""Files whose content has a schema: kept, read, and refused in one line that says what is wrong."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from realitygap.embedded_sim.errors import InputError, nearest, quoted
from realitygap.models.log.opened import json_values


class Table(BaseModel):
    """A table of a file: immutable, without unknown keys; a number is no text and no `true`."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @model_validator(mode="before")
    @classmethod
    def _with_tuples(cls, values: Any) -> Any:
        """A file has lists where a table has tuples."""
        if not isinstance(values, dict):
            return values
        return {name: _tuples(value) for name, value in values.items()}


def _tuples(value: Any) -> Any:
    """A list, and lists in it, as tuples."""
    return tuple(_tuples(one) for one in value) if isinstance(value, list) else value


class Finite(Table):
    """A table whose numbers are finite."""

    model_config = ConfigDict(allow_inf_nan=False)


Content = TypeVar("Content", bound=Table)


class Refused(ValueError):
    """A value that a validator refuses: which key below its own, what was there, what is valid."""

    def __init__(self, field: str, got: object, expected: str) -> None:
        self.field, self.got, self.expected = field, got, expected
        super().__init__(f"{field}: got {got}, expected {expected}")


def read_json(kind: type[Content], path: Path, what: str, *, field: str | None = None) -> Content:
    """Read a JSON file.

    Args:
        kind: Schema of the whole file.
        path: The file.
        what: Name of the kind, in a refusal.
        field: What is read, in a refusal to open it; its path if absent.

    Raises:
        InputError: it cannot be read, or as `checked`.
    """
    return checked(kind, json_values(path, f"{what} (JSON)", field=field), path, what)


def write_json(content: BaseModel, path: Path) -> None:
    """Write as JSON, numbers at full precision."""
    text = json.dumps(content.model_dump(mode="json"), indent=1, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def checked(kind: type[Content], values: object, path: Path, what: str) -> Content:
    """What a file holds, by its schema.

    Raises:
        InputError: the first unknown or missing key or wrong value; an unknown key with the
            nearest valid one.
    """
    try:
        return kind.model_validate(values)
    except ValidationError as error:
        raise _first_problem(kind, path, what, error) from None


def _first_problem(
    kind: type[BaseModel], path: Path, what: str, error: ValidationError
) -> InputError:
    """Which key, what was there, what is valid."""
    every = error.errors()
    first = every[0]
    if first["type"] == "missing":  # a misspelt key is missing under its right name, too
        unknown = (one for one in every if one["type"] == "extra_forbidden")
        beside = (one for one in unknown if one["loc"][:-1] == first["loc"][:-1])
        first = next(beside, first)
    # pydantic names its own validators, too
    keys = [str(part) for part in first["loc"] if not str(part).startswith("function-")]
    refused = first.get("ctx", {}).get("error")
    if isinstance(refused, Refused):
        keys += refused.field.split(".") if refused.field else []
        return InputError(f"{path.name}: {'.'.join(keys)}", refused.got, refused.expected)
    was = first["input"]
    got = quoted(list(was) if isinstance(was, tuple) else was)
    if not keys:
        return InputError(path.name, got, what)
    where = f"{path.name}: {'.'.join(keys)}"
    if first["type"] == "extra_forbidden":
        return InputError(where, "an unknown key", nearest(keys[-1], _keys_of(kind, keys[:-1])))
    if first["type"] == "missing":
        return InputError(where, "nothing", f"a value (the key must be there in {what})")
    if first["type"] == "model_type":
        return InputError(where, got, "a table")
    return InputError(where, got, first["msg"].removeprefix("Input should be "))


def _keys_of(kind: type[BaseModel], parents: list[str]) -> list[str]:
    """Valid keys of a nested table."""
    for parent in parents:
        field = kind.model_fields.get(parent)
        if field is not None:  # else a place in a list or a mapping, whose tables `kind` describes
            kind = next(_tables(field.annotation), kind)
    return [field.alias or name for name, field in kind.model_fields.items()]


def _tables(annotation: Any) -> Iterator[type[BaseModel]]:
    """The schemas that an annotation names."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _tables(inner)
